#include "core/graph/deep_stack.h"

#include <exception>
#include <system_error>

#include <pthread.h>

namespace mapweld {
namespace {

struct Task {
  const std::function<void()>& work;
  std::exception_ptr error;
};

void* run_task(void* argument) {
  Task& task = *static_cast<Task*>(argument);
  try {
    task.work();
  } catch (...) {
    task.error = std::current_exception();
  }
  return nullptr;
}

void check(int error) {
  if (error != 0) throw std::system_error(error, std::generic_category(), "a deep stack");
}

}  // namespace

void run_on_stack(std::size_t bytes, const std::function<void()>& work) {
  Task task{work, nullptr};
  pthread_attr_t attributes;
  check(pthread_attr_init(&attributes));
  int error = pthread_attr_setstacksize(&attributes, bytes);
  pthread_t thread{};
  if (error == 0) error = pthread_create(&thread, &attributes, run_task, &task);
  pthread_attr_destroy(&attributes);
  check(error);
  pthread_join(thread, nullptr);
  if (task.error) std::rethrow_exception(task.error);
}

}  // namespace mapweld
