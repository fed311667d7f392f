#pragma once

#include <fcntl.h>
#include <unistd.h>

namespace armada {

/// Opens /dev/null in the place of standard input, output and error where they are closed: else a file or a
/// socket of the program's own would get their numbers, and what the program says would be written into it.
/// First in main.
inline void OpenStandardFiles() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDWR) != fd) _exit(1);
  }
}

}  // namespace armada
