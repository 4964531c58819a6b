// SPDX-License-Identifier: Apache-2.0
// A video: pictures piped to the program ffmpeg.
#ifndef PHYSPRING_ROLLOUT_VIDEO_FILE_H_
#define PHYSPRING_ROLLOUT_VIDEO_FILE_H_

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "pictures/image.h"
#include "twin/draft_file.h"

namespace physpring {

// Images of one height as one. Not empty.
Image SideBySide(const std::vector<Image>& images);

class VideoFile {
 public:
  // The ending of `path` says the format: .mp4, or _%04d.png for a picture a frame. Throws Error
  // when there is no ffmpeg.
  VideoFile(std::string path, int width, int height, double rate);
  ~VideoFile();  // without Finish: gives up, and leaves no file
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  void Add(const Image& image);

  // Waits for ffmpeg; only now there is a file at `path`. Throws Error when ffmpeg failed.
  void Finish();

 private:
  void Stop();

  std::string path_;
  std::optional<DraftFile> draft_;  // what ffmpeg writes; none for many files
  int pipe_ = -1;
  pid_t process_ = -1;
  int status_ = 0;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_VIDEO_FILE_H_
