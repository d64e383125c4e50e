// Everything that differs between MuJoCo 2.2.2 and 4.0.0 as far as Crossgait goes, and nothing else of it:
// the rest of the folder is one source for all. What a release changed is decided by the headers'
// mjVERSION_HEADER, which grows from release to release (222, 316; from 3.5.0 on in thousands: 3005000).
#pragma once

#include <cstddef>
#include <string>

#include <mujoco/mujoco.h>

// The library exports these for its Python bindings; no public header declares them.
extern "C" {
#if mjVERSION_HEADER < 3010000
using MujocoHandler = void (*)(const char* message);
MJAPI MujocoHandler _mjPRIVATE__get_tls_error_fn();        // NOLINT(bugprone-reserved-identifier)
MJAPI void _mjPRIVATE__set_tls_error_fn(MujocoHandler);    // NOLINT(bugprone-reserved-identifier)
MJAPI MujocoHandler _mjPRIVATE__get_tls_warning_fn();      // NOLINT(bugprone-reserved-identifier)
MJAPI void _mjPRIVATE__set_tls_warning_fn(MujocoHandler);  // NOLINT(bugprone-reserved-identifier)
#else
MJAPI mjfLogHandler _mjPRIVATE_setTlsLogHandler(mjfLogHandler);  // NOLINT(bugprone-reserved-identifier)
#endif
}

namespace crossgait::mujoco {

/// Since 3.7.0 the reference acceleration of a loop's rows contains what the motion itself makes of them, J'
/// v, the time derivative of the constraint's Jacobian times velocity. MuJoCo has no switch for it.
inline constexpr bool kHasLoopBias = mjVERSION_HEADER >= 3007000;

/// Says what one thread does with MuJoCo's messages. It comes before what the process does (mju_user_error,
/// mju_setLogHandler).
struct ThreadHandlers {
#if mjVERSION_HEADER < 3010000
  MujocoHandler error, warning;
#else
  mjfLogHandler message;
#endif
};

/// Sends errors of this thread to `kOnError` from now on; all else is dropped (MuJoCo's default prints, and
/// writes a log file into the working directory). @returns what was there before
template <void (*kOnError)(const char* message)>
ThreadHandlers take_errors() noexcept {
#if mjVERSION_HEADER < 3010000
  const ThreadHandlers before{_mjPRIVATE__get_tls_error_fn(), _mjPRIVATE__get_tls_warning_fn()};
  _mjPRIVATE__set_tls_error_fn(kOnError);
  _mjPRIVATE__set_tls_warning_fn([](const char* /*message*/) {});
  return before;
#else
  return {_mjPRIVATE_setTlsLogHandler([](const mjLogMessage* message) {
    if (message->level == mjLOG_ERROR) kOnError(message->subject);
  })};
#endif
}

inline void give_back(const ThreadHandlers& before) noexcept {
#if mjVERSION_HEADER < 3010000
  _mjPRIVATE__set_tls_error_fn(before.error);
  _mjPRIVATE__set_tls_warning_fn(before.warning);
#else
  _mjPRIVATE_setTlsLogHandler(before.message);
#endif
}

/// What a collision routine is given, and what it fills in.
#if mjVERSION_HEADER < 3009000
using CollisionData = const mjData;
using FoundContact = mjContact;
inline mjtNum* normal_of(FoundContact& contact) { return contact.frame; }
inline mjtNum* tangent_of(FoundContact& contact) { return contact.frame + 3; }
#else
using CollisionData = mjData;
using FoundContact = mjPreContact;
inline mjtNum* normal_of(FoundContact& contact) { return contact.normal; }
inline mjtNum* tangent_of(FoundContact& contact) { return contact.tangent; }
#endif

/// How many contacts a collision routine may find between a plane and one cylinder or box. Since 3.9.0 MuJoCo
/// has room for no more than its own routines find (a sphere 1, a capsule 2), and some releases write beyond
/// it.
inline constexpr int kMaxPlaneContacts = mjVERSION_HEADER < 3009000 ? mjMAXCONPAIR : 4;

/// Returns what makes Newton's method as exact as up to 3.10: it stopped after the step that gained less than
/// the tolerance, and stops before it since 3.11.0 (the Newton decrement). It converges quadratically.
constexpr double solver_tolerance(double tolerance) {
  return mjVERSION_HEADER < 3011000 ? tolerance : tolerance * tolerance;
}

/// Adds a file in memory. @param name  without a folder, and not there yet; at most 2000 files
inline void add_file(mjVFS& files, const std::string& name, const std::string& bytes) {
#if mjVERSION_HEADER < 313
  mj_makeEmptyFileVFS(&files, name.c_str(), static_cast<int>(bytes.size()));
  bytes.copy(static_cast<char*>(files.filedata[files.nfile - 1]), bytes.size());
#else
  mj_addBufferVFS(&files, name.c_str(), bytes.data(), static_cast<int>(bytes.size()));
#endif
}

/// Measures from `from` along `direction` to the first geom of `groups`; negative if there is none.
inline mjtNum ray(const mjModel* m, const mjData* d, const mjtNum* from, const mjtNum* direction,
                  const mjtByte* groups) {
  int geom = -1;
#if mjVERSION_HEADER < 3005000
  return mj_ray(m, d, from, direction, groups, 1, -1, &geom);
#else
  return mj_ray(m, d, from, direction, groups, 1, -1, &geom, nullptr);
#endif
}

/// Computes the joint-space inertia, in MuJoCo's own storage: mj_crb alone leaves it as it was from 3.3.5 on.
inline void find_inertia(const mjModel* m, mjData* d) {
#if mjVERSION_HEADER < 333
  mj_crb(m, d);
#else
  mj_makeM(m, d);
#endif
}

/// Copies the inertia as a full matrix, nv x nv.
inline void copy_inertia(const mjModel* m, const mjData* d, mjtNum* matrix) {
#if mjVERSION_HEADER < 3010000
  mj_fullM(m, matrix, d->qM);
#else
  mj_fullM(m, d, matrix);
#endif
}

/// Tells whether a constraint of a model as it was compiled holds.
inline bool is_active(const mjModel& m, int equality) {
#if mjVERSION_HEADER < 300
  return m.eq_active[equality] != 0;
#else
  return m.eq_active0[equality] != 0;
#endif
}

/// Tells whether a constraint joins sites and not bodies.
inline bool joins_sites([[maybe_unused]] const mjModel& m, [[maybe_unused]] int equality) {
#if mjVERSION_HEADER < 323
  return false;
#else
  return m.eq_objtype[equality] == mjOBJ_SITE;
#endif
}

}  // namespace crossgait::mujoco
