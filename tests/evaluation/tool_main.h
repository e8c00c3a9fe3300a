// How the tools of the evaluation begin and how they fail.
#pragma once

#include <exception>
#include <iostream>

#include <opencv2/core/utility.hpp>

#include "core/feature/allocation.h"

namespace mapweld::evaluation {

// For a tool's main: OpenCV keeps to the thread that calls it, SIFT's memory is kept, and what `run` throws becomes a
// line on standard error behind the tool's name and the result 1; otherwise the result is that of `run`.
inline int tool_main(const char* name, int (*run)(int argc, char** argv), int argc, char** argv) {
  cv::setNumThreads(1);
  keep_freed_memory();
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace mapweld::evaluation
