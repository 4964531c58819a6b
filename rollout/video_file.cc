// SPDX-License-Identifier: Apache-2.0
#include "rollout/video_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "twin/error.h"

namespace physpring {
namespace {

// Starts a program that reads `input`; 0 or an error number.
int Start(std::vector<std::string> words, int input, pid_t* process) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  const int failure =
      posix_spawnp(process, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failure;
}

}  // namespace

VideoFile::VideoFile(std::string path, int width, int height, double rate)
    : path_(std::move(path)) {
  if (path_.find('%') == std::string::npos) {  // else it is many files
    RemoveAbandonedDrafts(path_);
    draft_.emplace(path_, std::filesystem::path(path_).extension().string());
    if (!draft_->is_open()) {
      throw Error(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
    }
  }
  // a socket, because writing to one whose reader died is an error and no signal
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw Error(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
  }
  pipe_ = ends[0];
  const bool pictures = path_.ends_with(".png");
  std::vector<std::string> command = {"ffmpeg",
                                      "-loglevel",
                                      "error",
                                      "-nostdin",
                                      "-y",
                                      "-f",
                                      "rawvideo",
                                      "-pix_fmt",
                                      "rgb24",
                                      "-s",
                                      fmt::format("{}x{}", width, height)};
  const auto add = [&](std::initializer_list<std::string> words) {
    command.insert(command.end(), words);
  };
  add({"-r", fmt::format("{}", rate), "-i", "pipe:0", "-threads", "1"});
  if (path_.ends_with(".mp4")) add({"-preset", "veryfast"});  // encoding must not outlast drawing
  add({"-pix_fmt", pictures ? "rgb24" : "yuv420p", draft_ ? draft_->name() : path_});
  const int failure = Start(command, ends[1], &process_);
  close(ends[1]);
  if (failure == 0) return;
  close(pipe_);
  throw Error(failure == ENOENT
                  ? path_ + ": videos need ffmpeg, which is not here: apt-get install ffmpeg"
                  : fmt::format("{}: ffmpeg cannot be started: {}", path_, std::strerror(failure)));
}

VideoFile::~VideoFile() {
  if (process_ >= 0) Stop();
}

void VideoFile::Add(const Image& image) {
  const unsigned char* bytes = image.rgb.data();
  std::size_t left = image.rgb.size();
  while (left > 0) {
    const ssize_t sent = send(pipe_, bytes, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) throw Error(path_ + ": ffmpeg ended early");
    bytes += sent;
    left -= static_cast<std::size_t>(sent);
  }
}

void VideoFile::Stop() {
  close(pipe_);
  while (waitpid(process_, &status_, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
}

void VideoFile::Finish() {
  Stop();
  const bool good = WIFEXITED(status_) && WEXITSTATUS(status_) == 0;
  if (good && (!draft_ || (draft_->Sync() && draft_->Rename()))) return;
  throw Error(path_ + ": ffmpeg could not write it");
}

Image SideBySide(const std::vector<Image>& images) {
  Image wide{0, images[0].height, {}};
  for (const Image& image : images) wide.width += image.width;
  for (int y = 0; y < wide.height; ++y) {
    for (const Image& image : images) {
      const auto row = image.rgb.begin() + static_cast<std::ptrdiff_t>(3) * image.width * y;
      wide.rgb.insert(wide.rgb.end(), row, row + static_cast<std::ptrdiff_t>(3) * image.width);
    }
  }
  return wide;
}

}  // namespace physpring
