// SPDX-License-Identifier: Apache-2.0
#include "pictures/png_file.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

// libpng's simplified interface: no jumps, and the size is known before anything is read.
class PngImage {
 public:
  explicit PngImage(std::string path) : path_(std::move(path)) {
    image_.version = PNG_IMAGE_VERSION;
  }
  ~PngImage() { png_image_free(&image_); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;

  // `pixels` has room for the picture in that format.
  template <class Number>
  void Read(const std::string& bytes, int width, int height, unsigned format,
            std::vector<Number>* pixels) {
    if (!png_image_begin_read_from_memory(&image_, bytes.data(), bytes.size())) Fail();
    if (image_.width != static_cast<unsigned>(width) ||
        image_.height != static_cast<unsigned>(height)) {
      throw Error(fmt::format("{}: has {} x {} pixels; {} x {} are expected", path_, image_.width,
                              image_.height, width, height));
    }
    const bool deep = (image_.format & PNG_FORMAT_FLAG_LINEAR) != 0;
    if (deep != (format == PNG_FORMAT_LINEAR_Y)) {
      throw Error(fmt::format("{}: has {} bits a channel; {} are expected", path_, deep ? 16 : 8,
                              deep ? 8 : 16));
    }
    image_.format = format;
    pixels->resize(PNG_IMAGE_PIXEL_CHANNELS(format) * static_cast<std::size_t>(width) * height);
    const png_color black{0, 0, 0};
    if (!png_image_finish_read(&image_, &black, pixels->data(), 0, nullptr)) Fail();
  }

  template <class Number>
  std::string Bytes(const std::vector<Number>& pixels, int width, int height, unsigned format) {
    image_.width = static_cast<unsigned>(width);
    image_.height = static_cast<unsigned>(height);
    image_.format = format;
    image_.flags = PNG_IMAGE_FLAG_FAST;
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image_), '\0');
    png_alloc_size_t size = bytes.size();
    if (!png_image_write_to_memory(&image_, bytes.data(), &size, 0, pixels.data(), 0, nullptr)) {
      Fail();
    }
    bytes.resize(size);
    return bytes;
  }

 private:
  [[noreturn]] void Fail() const {
    throw Error(fmt::format("{}: is no sound .png file: {}", path_, image_.message));
  }

  const std::string path_;
  png_image image_{};
};

// The file without what says how colours are to be seen: libpng would change the numbers.
std::string WithoutColourSpaces(const std::string& bytes) {
  constexpr std::size_t kSignature = 8, kOfChunk = 12;  // length, name, check
  std::string kept = bytes.substr(0, kSignature);
  for (std::size_t at = kSignature; at + kOfChunk <= bytes.size();) {
    std::size_t size = kOfChunk;
    for (int i = 0; i < 4; ++i) {
      size += std::size_t{static_cast<unsigned char>(bytes[at + i])} << (24 - 8 * i);
    }
    const std::string_view name = std::string_view(bytes).substr(at + 4, 4);
    const bool is_space =
        name == "gAMA" || name == "sRGB" || name == "cHRM" || name == "iCCP" || name == "cICP";
    if (!is_space) kept.append(bytes, at, size);
    at += size;
  }
  return kept;
}

// No sound file of that many pixels has more bytes.
std::string ReadBytes(const std::string& path, int width, int height) {
  constexpr std::size_t kMostBytesOfPixel = 8, kRest = 1 << 20;
  const std::string bytes = ReadFile(path, kMostBytesOfPixel * width * height + kRest);
  if (bytes.empty()) throw Error(path + ": is empty");
  return WithoutColourSpaces(bytes);
}

}  // namespace

Image ReadColours(const std::string& path, int width, int height) {
  Image image{width, height, {}};
  PngImage(path).Read(ReadBytes(path, width, height), width, height, PNG_FORMAT_RGB, &image.rgb);
  return image;
}

Mask ReadMask(const std::string& path, int width, int height) {
  Mask mask{width, height, {}};
  PngImage(path).Read(ReadBytes(path, width, height), width, height, PNG_FORMAT_GRAY, &mask.kind);
  for (const unsigned char kind : mask.kind) {
    if (kind != kElsewhere && kind != kHidden && kind != kObject) {
      throw Error(
          fmt::format("{}: has a pixel of {}; a mask has {} (elsewhere), {} (hidden) and "
                      "{} (object)",
                      path, kind, static_cast<int>(kElsewhere), static_cast<int>(kHidden),
                      static_cast<int>(kObject)));
    }
  }
  return mask;
}

DepthImage ReadDepth(const std::string& path, int width, int height, double unit) {
  std::vector<std::uint16_t> units;
  PngImage(path).Read(ReadBytes(path, width, height), width, height, PNG_FORMAT_LINEAR_Y, &units);
  DepthImage depth{width, height, std::vector<float>(units.size())};
  std::transform(units.begin(), units.end(), depth.metres.begin(),
                 [unit](std::uint16_t count) { return static_cast<float>(unit * count); });
  return depth;
}

std::string PngBytes(const Image& image) {
  return PngImage("a picture").Bytes(image.rgb, image.width, image.height, PNG_FORMAT_RGB);
}

void WritePng(const Image& image, const std::string& path) {
  WriteFileAtomically(path, PngBytes(image));
}

void WritePng(const Mask& mask, const std::string& path) {
  WriteFileAtomically(path,
                      PngImage(path).Bytes(mask.kind, mask.width, mask.height, PNG_FORMAT_GRAY));
}

void WritePng(const DepthImage& depth, double unit, const std::string& path) {
  constexpr double kMost = 65535;
  std::vector<std::uint16_t> units(depth.metres.size());
  std::transform(depth.metres.begin(), depth.metres.end(), units.begin(), [unit](float metres) {
    const double count = std::round(static_cast<double>(metres) / unit);
    return static_cast<std::uint16_t>(count >= 0 && count <= kMost ? count : 0);
  });
  WriteFileAtomically(path,
                      PngImage(path).Bytes(units, depth.width, depth.height, PNG_FORMAT_LINEAR_Y));
}

}  // namespace physpring
