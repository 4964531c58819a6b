// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cli/message.h"

namespace physpring {
namespace {

constexpr int kBarWidth = 20;
constexpr std::chrono::milliseconds kRedraw{100};
constexpr std::chrono::seconds kNextLine{10};

int TerminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string FormatDuration(double seconds) {
  if (seconds < 10) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string FormatProgress(double share, double seconds_left, const std::string& status,
                           int width) {
  std::string text;
  if (width > 0) {
    const auto filled = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * kBarWidth);
    text = fmt::format("[{:.<{}}] ", std::string(filled, '#'), kBarWidth);
  }
  text += fmt::format("{:3.0f} %", 100 * share);
  if (seconds_left >= 0) text += ", " + FormatDuration(seconds_left) + " left";
  text += ", " + status;
  if (width > 0) text.resize(std::min(text.size(), static_cast<std::size_t>(width)));
  return text;
}

Progress::Progress(double share) : terminal_(isatty(STDERR_FILENO) == 1), start_share_(share) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\n", stderr);
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

double Progress::SecondsLeft(double share) const {
  const double done = share - start_share_;
  return done > 0 ? seconds() / done * (1 - share) : -1;
}

void Progress::Say(const std::string& line) const {
  Tell("{}{}\n", drawn_ ? "\r\x1b[K" : "", line);
}

void Progress::Show(double share, const std::string& status) {
  const Clock::time_point now = Clock::now();
  if (now - shown_ < (terminal_ ? Clock::duration(kRedraw) : Clock::duration(kNextLine))) return;
  shown_ = now;
  const double left = SecondsLeft(share);
  if (terminal_) {
    // one column less: a full line would wrap; the escape sequence clears the rest of the line
    const std::string bar = FormatProgress(share, left, status, TerminalWidth() - 1);
    Tell("\r{}\x1b[K", bar);
    std::fflush(stderr);
    drawn_ = true;
  } else {
    Tell("{}\n", FormatProgress(share, left, status, 0));
  }
}

}  // namespace physpring
