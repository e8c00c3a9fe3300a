// SIFT allocates and frees some 20 MB an image. glibc's malloc gives such blocks back to the kernel at once and pays a
// page fault for every 4 KiB when it asks for them again.
#pragma once

namespace mapweld {

// Lets the process keep freed memory for the next image. Process-wide: a program's main calls it once, before it starts
// threads; the core never does. Does nothing on a C library without mallopt.
void keep_freed_memory();

// Gives what is kept back to the kernel; takes some milliseconds. Any thread. Does nothing on a C library without
// malloc_trim.
void give_back_freed_memory();

}  // namespace mapweld
