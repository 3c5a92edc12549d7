// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>

/// Annotations for clang's thread safety analysis (-Wthread-safety): the data that a lock guards, and the locks that a
/// function acquires, releases or requires. Other compilers ignore them.
#if defined(__clang__)
#define HOLDFAST_THREAD_ANNOTATION(attribute) __attribute__((attribute))
#else
#define HOLDFAST_THREAD_ANNOTATION(attribute)
#endif
#define HOLDFAST_CAPABILITY(name) HOLDFAST_THREAD_ANNOTATION(capability(name))
#define HOLDFAST_SCOPED_CAPABILITY HOLDFAST_THREAD_ANNOTATION(scoped_lockable)
#define HOLDFAST_GUARDED_BY(lock) HOLDFAST_THREAD_ANNOTATION(guarded_by(lock))
#define HOLDFAST_REQUIRES(...) HOLDFAST_THREAD_ANNOTATION(requires_capability(__VA_ARGS__))
#define HOLDFAST_EXCLUDES(...) HOLDFAST_THREAD_ANNOTATION(locks_excluded(__VA_ARGS__))
#define HOLDFAST_ACQUIRE(...) HOLDFAST_THREAD_ANNOTATION(acquire_capability(__VA_ARGS__))
#define HOLDFAST_TRY_ACQUIRE(...) HOLDFAST_THREAD_ANNOTATION(try_acquire_capability(__VA_ARGS__))
#define HOLDFAST_RELEASE(...) HOLDFAST_THREAD_ANNOTATION(release_capability(__VA_ARGS__))

namespace holdfast {

/// A std::mutex with the annotations of the analysis.
class HOLDFAST_CAPABILITY("mutex") Mutex {
 public:
  void lock() HOLDFAST_ACQUIRE() { mutex_.lock(); }
  bool try_lock() HOLDFAST_TRY_ACQUIRE(true) { return mutex_.try_lock(); }
  void unlock() HOLDFAST_RELEASE() { mutex_.unlock(); }

 private:
  std::mutex mutex_;
};

/// Holds a Mutex during its lifetime.
class HOLDFAST_SCOPED_CAPABILITY MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) HOLDFAST_ACQUIRE(mutex) : mutex_(mutex) { mutex_.lock(); }
  ~MutexLock() HOLDFAST_RELEASE() { mutex_.unlock(); }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

 private:
  Mutex& mutex_;
};

}  // namespace holdfast
