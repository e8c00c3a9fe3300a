#include <cerrno>
#include <system_error>

#include <seccomp.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include "server/decoding/decoder_process.h"

namespace mapweld::server {
namespace {

void limit(__rlimit_resource resource, rlim_t value) {
  const rlimit both{value, value};
  if (::setrlimit(resource, &both) != 0) throw std::system_error(errno, std::generic_category(), "setrlimit");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

class Filter {
 public:
  Filter() : context_(seccomp_init(SCMP_ACT_KILL_PROCESS)) {
    if (context_ == nullptr) throw std::system_error(ENOMEM, std::generic_category(), "seccomp_init");
  }
  ~Filter() { seccomp_release(context_); }
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;

  void allow(int call) { check(seccomp_rule_add(context_, SCMP_ACT_ALLOW, call, 0)); }
  // Memory that can be executed is not to be had.
  void allow_without_execution(int call) {
    check(seccomp_rule_add(context_, SCMP_ACT_ALLOW, call, 1,
                           SCMP_CMP(2, SCMP_CMP_MASKED_EQ, static_cast<scmp_datum_t>(PROT_EXEC), 0)));
  }
  void refuse(int call) { check(seccomp_rule_add(context_, SCMP_ACT_ERRNO(EACCES), call, 0)); }
  void load() { check(seccomp_load(context_)); }

 private:
  static void check(int outcome) {
    if (outcome < 0) throw std::system_error(-outcome, std::generic_category(), "seccomp");
  }
  scmp_filter_ctx context_;
};

void allow_little() {
  Filter filter;
  for (const int call :
       {SCMP_SYS(read), SCMP_SYS(write), SCMP_SYS(munmap), SCMP_SYS(mremap), SCMP_SYS(brk), SCMP_SYS(madvise),
        SCMP_SYS(futex), SCMP_SYS(exit), SCMP_SYS(exit_group), SCMP_SYS(rt_sigreturn), SCMP_SYS(clock_gettime),
        SCMP_SYS(sched_yield), SCMP_SYS(getrandom), SCMP_SYS(getpid)}) {
    filter.allow(call);
  }
  filter.allow_without_execution(SCMP_SYS(mmap));
  filter.allow_without_execution(SCMP_SYS(mprotect));
  // Libraries look at the machine when they are first used; what they find there does not matter.
  for (const int call : {SCMP_SYS(openat), SCMP_SYS(newfstatat), SCMP_SYS(access), SCMP_SYS(readlink),
                         SCMP_SYS(sched_getaffinity), SCMP_SYS(sysinfo), SCMP_SYS(uname)}) {
    filter.refuse(call);
  }
  filter.load();
}

#endif

}  // namespace

void enter_sandbox(std::size_t max_memory_bytes) {
  limit(RLIMIT_CORE, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_NOFILE, 0);
  limit(RLIMIT_DATA, max_memory_bytes);
  allow_little();
#else
  static_cast<void>(max_memory_bytes);
#endif
}

}  // namespace mapweld::server
