// SPDX-License-Identifier: Apache-2.0
/// Limits for the motion of a picture that fills the room, so that it does not cause motion sickness. The walk stays
/// within them by construction (walk.h); tests measure this on the displayed views.
///
/// Sources, and what follows from them:
///  [1] Oculus Best Practices, "Motion" (developer.oculus.com/design/latest/concepts/bp_app_motion): walking is
///      1.4 m/s, jogging 3 m/s; accelerations should be short and infrequent, since the vestibular system does not feel
///      them.
///  [2] So, Lo, Ho: Effects of navigation speed on motion sickness caused by an immersive virtual environment. Human
///      Factors 43(3), 2001, 452-461: nausea and vection grow from 3 to 10 m/s (r.m.s.).
///  [3] de Winkel, Irmak, Happee, Shyrokau: Standards for passenger comfort in automated vehicles: acceleration and
///      jerk. Applied Ergonomics 106, 2023: pulses of 0.4-2 m/s² and 0.5-15 m/s³; discomfort grows with acceleration,
///      and of equal accelerations the shorter, with higher jerk, are the MORE comfortable.
///  [4] Bonato, Story, Bubka, Aviat Space Environ Med 2005 (rotation direction change in an optokinetic drum), and
///      Bubka et al. 2003 (drum tilt): a drum at 60 deg/s makes most subjects unwell within minutes, at 30 deg/s later.
///
/// Speeds therefore stay at or below a stroll, and turning stays well below the drum's 60 deg/s. Accelerations are
/// short (0.58 s from rest to full speed) and below the 2.5 m/s² of a person who starts to walk. The jerk limit is not
/// for comfort: a start or stop takes at least seven refreshes of 1/60 s, so that it looks like motion and not like a
/// cut.
#pragma once

namespace cyclorama::tour {

/// Upper bounds of the default walk, in the visitor's metres (a scene's metres divided by its walking_scale).
struct ComfortLimits {
  /// Bound for each of forward and sideways. It is below the walking speed of 1.4 m/s in [1], and a third of the lowest
  /// speed in [2].
  double speed_m_per_s = 1.0;
  double turn_rad_per_s = 0.7;                ///< 40 deg/s; [4].
  double acceleration_m_per_s2 = 2.2;         ///< Bound for each of forward and sideways; [3], [1].
  double jerk_m_per_s3 = 18.0;                ///< Bound for each of forward and sideways.
  double turn_acceleration_rad_per_s2 = 1.6;  ///< 92 deg/s².
  double turn_jerk_rad_per_s3 = 12.5;         ///< 716 deg/s³.
};
inline constexpr ComfortLimits kComfort{};

}  // namespace cyclorama::tour
