// SPDX-License-Identifier: Apache-2.0
// Pictures of a recording, as cameras saw it: a folder with
//   cameras.json            the cameras, and how many frames there are
//   color/NAME/00000.png    what camera NAME saw in frame 0, 8 bits of red, green, blue
//   mask/NAME/00000.png     what of it is the object: PixelKind
//   depth/NAME/00000.png    how far it is along the view, 16 bits, in `depth_unit` m; 0: unknown.
//                           Not always there
#ifndef PHYSPRING_PICTURES_PICTURE_FOLDER_H_
#define PHYSPRING_PICTURES_PICTURE_FOLDER_H_

#include <string>
#include <vector>

#include "pictures/camera.h"
#include "pictures/image.h"

namespace physpring {

struct RecordedCamera {
  std::string name;
  PinholeCamera view;
};

class PictureFolder {
 public:
  // Reads cameras.json:
  //   {"format": "physpring pictures", "version": 1, "fps": 30, "frames": 120,
  //    "depth_unit": 0.0001,                      left out: there is no depth
  //    "cameras": [{"name": "front", "width": 640, "height": 480, "fx": 600, "fy": 600,
  //                 "cx": 320, "cy": 240, "pose": [16 numbers]}]}
  // `pose`: the 4 x 4 matrix from the camera to the world, row by row; x to the right, y down, z
  // into the picture. Throws Error, one line that begins with the file's path.
  explicit PictureFolder(const std::string& path);

  // A new one, of which nothing is written yet. Throws Error for cameras that have no plain names
  // (twin/plain_name.h), or one of another.
  PictureFolder(std::string path, double fps, int frames, double depth_unit,
                std::vector<RecordedCamera> cameras);

  // Makes the folders of the pictures. They are none of a recording until cameras.json is written,
  // when all are there: so Error is thrown where it is there already, and none are lost.
  void MakeFolders() const;
  void WriteCameras() const;
  // Removes the first frames' pictures that were written, and folders that are empty then.
  void Remove(int frames) const;

  const std::string& path() const { return path_; }
  double fps() const { return fps_; }
  int frame_count() const { return frames_; }
  bool has_depth() const { return depth_unit_ > 0; }
  const std::vector<RecordedCamera>& cameras() const { return cameras_; }
  // The number of the camera. Throws Error, which lists those that there are.
  int CameraOf(const std::string& name) const;

  // Throw Error, one line that begins with the picture's path.
  Image ReadImage(int camera, int frame) const;
  Mask ReadObjectMask(int camera, int frame) const;
  DepthImage ReadDepthImage(int camera, int frame) const;
  void Write(int camera, int frame, const Image& image) const;
  void Write(int camera, int frame, const Mask& mask) const;
  void Write(int camera, int frame, const DepthImage& depth) const;

 private:
  std::string PathOf(const char* kind, int camera, int frame) const;
  std::string FolderOf(const char* kind, const std::string& camera) const;

  std::string path_;
  double fps_ = 0;
  int frames_ = 0;
  double depth_unit_ = 0;  // m
  std::vector<RecordedCamera> cameras_;
};

}  // namespace physpring

#endif  // PHYSPRING_PICTURES_PICTURE_FOLDER_H_
