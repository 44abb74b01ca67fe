#pragma once

#include <fcntl.h>
#include <unistd.h>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

/// The bytes of one input as a file of this process, in memory where the machine offers that.
inline const std::string& scratch_file(const char* ending, const std::uint8_t* data, std::size_t size) {
  static const std::string path = [&] {
    const std::string folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    return folder + "/slipmode_fuzz_" + std::to_string(getpid()) + ending;
  }();
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  close(file);
  static const bool removed_at_exit = std::atexit([] { unlink(scratch_file("", nullptr, 0).c_str()); }) == 0;
  static_cast<void>(removed_at_exit);
  return path;
}
