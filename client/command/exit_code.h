// What the `mapweld` command tells scripts when it ends (docs/cli.md, "Exit codes").
#pragma once

namespace mapweld::command {

enum ExitCode : int {
  kDone = 0,
  kServerSaidNo = 1,   // the server answered with a problem
  kUsage = 2,          // the command line, or a local file or folder, is not right
  kNoConnection = 3,   // no server answers, or the connection was lost
  kNotLocalized = 4,   // localize: at least one image was not found, or found in two places
  kSomeRefused = 5,    // upload, localize: the server refused some of the images, the others were served
  kMergeNotDone = 6,   // the merge that was waited for failed or was cancelled
  kInterrupted = 130,  // Ctrl-C
};

inline constexpr const char* kExitCodeHelp =
    "Exit codes:\n"
    "  0  done\n"
    "  1  the server said no (its problem is printed)\n"
    "  2  wrong usage, or a file or folder that cannot be read or written\n"
    "  3  no connection to the server\n"
    "  4  localize: at least one image was not localized\n"
    "  5  upload, localize: some images were refused, the others were served\n"
    "  6  the merge that was waited for failed or was cancelled\n";

}  // namespace mapweld::command
