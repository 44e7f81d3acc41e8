// SPDX-License-Identifier: Apache-2.0
/// The coordinate frames. All are right-handed, in metres.
///
///   Room       origin on the floor at the datum mark; x right, y up, z towards the visitor (glTF).
///   Scene      the digitised site; y up (glTF). The visitor's eye and heading place the room in it.
///   Eye        origin at the visitor's eye (the sweet spot); x right, y up, z back; a heading turns it about y.
///   Camera     origin at the centre of projection; x right, y down, z forward (the OpenCV convention).
///   Projector  like Camera: a projector is modelled as an inverse camera.
///   Tag        of the pattern that the visitor holds, a flat tag or a wand of several tags: origin at its centre; seen
///              upright from the front, x right, y down, z into the tag or wand.
///   Face       of one tag on a wand: like Tag, but at the centre of that tag.
///
/// A pixel is addressed (u, v) with u right, v down and the CENTRE of the first pixel at (0.5, 0.5).
/// A heading is in radians, positive to the right (clockwise seen from above); at heading 0 the eye looks along -z.
#pragma once
namespace cyclorama::frame {
struct Room;
struct Scene;
struct Eye;
struct Camera;
struct Projector;
struct Tag;
struct Face;
}  // namespace cyclorama::frame
