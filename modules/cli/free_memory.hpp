// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

/// Makes the process return buffers of more than 4 MB to the system when they are freed, and unused ends of heaps above
/// 8 MB. By default, glibc takes buffers from the heap that are smaller than the largest one freed so far (up to 32 MB)
/// and keeps twice as much at the end of the heap of every thread: after an adjustment of the whole map it kept all the
/// memory that this had taken. The images of a frame are smaller than 4 MB and come from the heap. Has no effect with
/// other C libraries, or where the environment says what glibc does (GLIBC_TUNABLES). Called once, by the program,
/// since it concerns the whole process.
void limit_free_memory();

/// Gives what is free within the heaps back to the system (malloc_trim of glibc). Without it, the memory of a run of
/// hours grows although what it uses does not: the free space between buffers that stay is of no use to larger ones.
/// From any thread; others that allocate may wait for some milliseconds. Has no effect with other C libraries.
void return_free_memory();

}  // namespace holdfast
