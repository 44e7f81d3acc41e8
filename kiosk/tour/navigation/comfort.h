// SPDX-License-Identifier: Apache-2.0
/// How fast a picture that fills the room may move before it makes people unwell. The walk stays within these numbers
/// by construction (walk.h); tests measure that on what is shown.
///
/// Sources, and what we take from them:
///  [1] Oculus Best Practices, "Motion" (developer.oculus.com/design/latest/concepts/bp_app_motion): walking is 1.4
///  m/s,
///      jogging 3 m/s; keep accelerations short and infrequent, since they are what the balance organ misses.
///  [2] So, Lo, Ho: Effects of navigation speed on motion sickness caused by an immersive virtual environment. Human
///      Factors 43(3), 2001, 452-461: nausea and vection grow from 3 to 10 m/s (r.m.s.).
///  [3] de Winkel, Irmak, Happee, Shyrokau: Standards for passenger comfort in automated vehicles: acceleration and
///  jerk.
///      Applied Ergonomics 106, 2023: pulses of 0.4-2 m/s² and 0.5-15 m/s³; discomfort grows with the acceleration, and
///      of equal ones the shorter, of higher jerk, are the MORE comfortable.
///  [4] Bonato, Story, Bubka, Aviat Space Environ Med 2005 (rotation direction change in an optokinetic drum), and
///      Bubka et al. 2003 (drum tilt): a drum at 60 deg/s makes most subjects unwell within minutes, at 30 deg/s later.
///
/// So speeds stay at or below a stroll; turning stays well below a drum's 60 deg/s; accelerations are short (0.58 s
/// from rest to full speed) and below the 2.5 m/s² of a person who starts to walk; and jerk is limited for another
/// reason than the body's: a start or stop takes at least seven refreshes of 1/60 s, so that it is seen as motion, not
/// as a cut.
#pragma once

namespace cyclorama {

/// The most that the default walk shows, in the visitor's metres (of a scene times its walking_scale).
struct ComfortLimits {
  double speed_m_per_s =
      1.0;  ///< Along each of forward and sideways. Below [1]'s walk of 1.4, a third of where [2] begins.
  double turn_rad_per_s = 0.7;                ///< 40 degrees; [4].
  double acceleration_m_per_s2 = 2.2;         ///< The same; [3], [1].
  double jerk_m_per_s3 = 18.0;                ///< The same.
  double turn_acceleration_rad_per_s2 = 1.6;  ///< 92 degrees.
  double turn_jerk_rad_per_s3 = 12.5;         ///< 716 degrees.
};
inline constexpr ComfortLimits kComfort{};

}  // namespace cyclorama
