#include <slipmode/core/progress.hpp>

#include <slipmode/core/terminal.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace slipmode {

namespace {

constexpr auto kInterval = std::chrono::milliseconds(100);

bool is_visible(ProgressMode mode) {
  if (mode == ProgressMode::kAutomatic) return isatty(STDERR_FILENO) == 1;
  return mode == ProgressMode::kAlways;
}

std::string clock_text(double seconds) {
  const auto s = static_cast<long>(std::ceil(seconds));
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

std::string progress_text(const std::string& label, std::size_t done, std::size_t total, double elapsed_s) {
  if (total == 0) return label;
  const double share = static_cast<double>(done) / static_cast<double>(total);
  std::string text = fmt::format("{}  {}/{}  {:3.0f} %", label, done, total, std::floor(100.0 * share));
  if (done == total) return text + fmt::format("  took {}", clock_text(elapsed_s));
  if (done > 0) text += fmt::format("  left {}", clock_text(elapsed_s * (1.0 - share) / share));
  return text;
}

ProgressLine::ProgressLine(std::string label, ProgressMode mode)
    : label_(std::move(label)), visible_(is_visible(mode)), start_(Clock::now()), last_(start_ - kInterval) {}

ProgressLine::~ProgressLine() {
  if (begun_) std::fputc('\n', stderr);
}

void ProgressLine::update(std::size_t done, std::size_t total) {
  if (!visible_) return;
  const auto now = Clock::now();
  if (done < total && now - last_ < kInterval) return;
  last_ = now;
  begun_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const std::string text = progress_text(label_, done, total, elapsed);
  std::fputc('\r', stderr);
  std::fputs(row_of(text, terminal_columns(STDERR_FILENO)).c_str(), stderr);
  std::fflush(stderr);
}

ProgressCallback ProgressLine::callback() {
  return [this](std::size_t done, std::size_t total) { update(done, total); };
}

}  // namespace slipmode
