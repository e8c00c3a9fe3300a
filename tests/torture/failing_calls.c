// LD_PRELOAD: makes calls of one kind fail, from the Nth on or that one alone, as a control file says that a test
// writes.
//
//   FAILING_CALLS_CONTROL   the file, which holds one struct control
//   FAILING_CALLS_UNDER     files are opened in vain under this folder alone
//
// Calls on files count for regular files alone. Only `mapweld-server serve`, `backup` and `restore` are hit, not the
// processes that they start; and not what OpenCV itself allocates: its destructors throw where its buffers could not be
// had (cv::utils::BufferArea, 4.6), which ends any process.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum kind { NONE, WRITE, SYNC, TRUNCATE, OPEN, MMAP, READ, FALLOCATE, UNLINK, RENAME, MEMORY };

struct control {
  _Atomic uint32_t kind;
  _Atomic uint32_t for_ever;  // and not the `from`th alone
  _Atomic int64_t from;       // from 1; 0: none fails, they are counted
  _Atomic int64_t min_bytes;  // of MEMORY: smaller ones neither fail nor count
  _Atomic int32_t error;      // the errno
  _Atomic uint32_t reserved;
  _Atomic int64_t seen;
  _Atomic int64_t failed;
};

static struct control* control;
static pid_t process;
static const char* under;

#define REAL(name)               \
  static __typeof__(name)* real; \
  if (real == NULL) real = (__typeof__(real))dlsym(RTLD_NEXT, #name)

static int is_due(enum kind kind) {
  if (control == NULL || atomic_load(&control->kind) != (uint32_t)kind || getpid() != process) return 0;
  const int64_t from = atomic_load(&control->from);
  const int64_t at = atomic_fetch_add(&control->seen, 1) + 1;
  if (from == 0 || at < from || (at > from && !atomic_load(&control->for_ever))) return 0;
  atomic_fetch_add(&control->failed, 1);
  errno = atomic_load(&control->error);
  return 1;
}

static int on_file(int descriptor) {
  struct stat status;
  const int before = errno;
  const int regular = control != NULL && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  errno = before;
  return regular;
}

struct range {
  uintptr_t begin;
  uintptr_t end;
};
static struct range spared[8];
static int spared_count;

static int note_library(struct dl_phdr_info* info, size_t size, void* data) {
  (void)size;
  (void)data;
  if (strstr(info->dlpi_name, "libopencv_") == NULL) return 0;
  for (int i = 0; i < info->dlpi_phnum && spared_count < 8; ++i) {
    const ElfW(Phdr)* part = &info->dlpi_phdr[i];
    if (part->p_type != PT_LOAD || !(part->p_flags & PF_X)) continue;
    const uintptr_t begin = info->dlpi_addr + part->p_vaddr;
    spared[spared_count++] = (struct range){begin, begin + part->p_memsz};
  }
  return 0;
}

static int is_spared(const void* caller) {
  for (int i = 0; i < spared_count; ++i) {
    if ((uintptr_t)caller >= spared[i].begin && (uintptr_t)caller < spared[i].end) return 1;
  }
  return 0;
}

__attribute__((constructor)) static void begin(void) {
  char line[4096] = {0};
  const char* file = getenv("FAILING_CALLS_CONTROL");
  under = getenv("FAILING_CALLS_UNDER");
  int descriptor = open("/proc/self/cmdline", O_RDONLY | O_CLOEXEC);
  if (file == NULL || descriptor < 0) return;
  const ssize_t length = read(descriptor, line, sizeof line - 1);
  close(descriptor);
  const char* command = line + strlen(line) + 1;
  if (length <= 0 || command >= line + length ||
      (strcmp(command, "serve") != 0 && strcmp(command, "backup") != 0 && strcmp(command, "restore") != 0)) {
    return;
  }
  descriptor = open(file, O_RDWR | O_CLOEXEC);
  void* mapped = mmap(NULL, sizeof(struct control), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  close(descriptor);
  if (mapped == MAP_FAILED) {
    perror(file);
    _exit(125);
  }
  dl_iterate_phdr(note_library, NULL);
  process = getpid();
  control = mapped;
}

#define ON_FILE(kind, type, name, parameters, descriptor, arguments)  \
  type name parameters {                                              \
    REAL(name);                                                       \
    return on_file(descriptor) && is_due(kind) ? -1 : real arguments; \
  }

ON_FILE(WRITE, ssize_t, write, (int fd, const void* data, size_t count), fd, (fd, data, count))
ON_FILE(WRITE, ssize_t, pwrite, (int fd, const void* data, size_t count, off_t at), fd, (fd, data, count, at))
ON_FILE(WRITE, ssize_t, pwrite64, (int fd, const void* data, size_t count, off64_t at), fd, (fd, data, count, at))
ON_FILE(READ, ssize_t, read, (int fd, void* data, size_t count), fd, (fd, data, count))
ON_FILE(READ, ssize_t, pread, (int fd, void* data, size_t count, off_t at), fd, (fd, data, count, at))
ON_FILE(READ, ssize_t, pread64, (int fd, void* data, size_t count, off64_t at), fd, (fd, data, count, at))
ON_FILE(SYNC, int, fsync, (int fd), fd, (fd))
ON_FILE(SYNC, int, fdatasync, (int fd), fd, (fd))
ON_FILE(TRUNCATE, int, ftruncate, (int fd, off_t length), fd, (fd, length))
ON_FILE(TRUNCATE, int, ftruncate64, (int fd, off64_t length), fd, (fd, length))

#define FALLOCATING(name, offset)                                           \
  int name(int fd, offset at, offset length) {                              \
    REAL(name);                                                             \
    return on_file(fd) && is_due(FALLOCATE) ? errno : real(fd, at, length); \
  }
FALLOCATING(posix_fallocate, off_t)
FALLOCATING(posix_fallocate64, off64_t)

#define OPENING(name)                                                                                \
  int name(const char* file, int flags, ...) {                                                       \
    REAL(name);                                                                                      \
    va_list more;                                                                                    \
    va_start(more, flags);                                                                           \
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0;                    \
    va_end(more);                                                                                    \
    const int counts = control != NULL && under != NULL && strncmp(file, under, strlen(under)) == 0; \
    return counts && is_due(OPEN) ? -1 : real(file, flags, mode);                                    \
  }
OPENING(open)
OPENING(open64)

#define MAPPING(name, offset)                                                                                      \
  void* name(void* address, size_t length, int protection, int flags, int fd, offset at) {                         \
    REAL(name);                                                                                                    \
    return fd >= 0 && on_file(fd) && is_due(MMAP) ? MAP_FAILED : real(address, length, protection, flags, fd, at); \
  }
MAPPING(mmap, off_t)
MAPPING(mmap64, off64_t)

int unlink(const char* file) {
  REAL(unlink);
  return is_due(UNLINK) ? -1 : real(file);
}

int rename(const char* from, const char* to) {
  REAL(rename);
  return is_due(RENAME) ? -1 : real(from, to);
}

// Without dlsym, which allocates.
extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static int no_memory(size_t bytes, const void* caller) {
  return control != NULL && bytes >= (size_t)atomic_load(&control->min_bytes) && !is_spared(caller) && is_due(MEMORY);
}
#define NO_MEMORY(bytes) no_memory(bytes, __builtin_return_address(0))

void* malloc(size_t bytes) { return NO_MEMORY(bytes) ? NULL : __libc_malloc(bytes); }

void* calloc(size_t count, size_t bytes) { return NO_MEMORY(count * bytes) ? NULL : __libc_calloc(count, bytes); }

void* realloc(void* old, size_t bytes) { return NO_MEMORY(bytes) ? NULL : __libc_realloc(old, bytes); }

void* aligned_alloc(size_t to, size_t bytes) { return NO_MEMORY(bytes) ? NULL : __libc_memalign(to, bytes); }

void* memalign(size_t to, size_t bytes) { return NO_MEMORY(bytes) ? NULL : __libc_memalign(to, bytes); }

int posix_memalign(void** result, size_t to, size_t bytes) {
  *result = NO_MEMORY(bytes) ? NULL : __libc_memalign(to, bytes);
  return *result == NULL ? ENOMEM : 0;
}
