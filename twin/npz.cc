// SPDX-License-Identifier: Apache-2.0
#include "twin/npz.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cassert>
#include <memory>
#include <new>
#include <string_view>

#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npy.h"
#include "twin/quote.h"

namespace physpring {
namespace {

// What all arrays together may take as doubles, in bytes: whoever reads them holds them so, and a
// small type becomes eight times as large.
constexpr std::size_t kLargestContent = std::size_t{1} << 32;
// A small file stands for no more than this and this many times its size: zeros that are packed a
// thousandfold are a trap.
constexpr std::size_t kLargestOfSmallFile = std::size_t{1} << 28, kLargestUnpacking = 64;
constexpr std::size_t kLargestDeflateRatio = 1032;  // the format's limit: RFC 1951
constexpr std::size_t kLargestNpyHeader = 1 << 16;  // bytes

struct CloseZip {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_source_t* source) const { zip_source_free(source); }
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};
template <typename T>
using ZipHandle = std::unique_ptr<T, CloseZip>;

class ZipError {
 public:
  ZipError() { zip_error_init(&error_); }
  ~ZipError() { zip_error_fini(&error_); }
  ZipError(const ZipError&) = delete;
  ZipError& operator=(const ZipError&) = delete;

  zip_error_t* get() { return &error_; }
  std::string text() { return zip_error_strerror(&error_); }

 private:
  zip_error_t error_;
};

// What the arrays of a file of so many bytes may hold, in bytes.
std::size_t LargestContent(std::size_t file) {
  return std::min(kLargestContent,
                  kLargestOfSmallFile + kLargestUnpacking * std::min(file, kLargestContent));
}

// One member while it is read. Its messages have no path; ReadNpz puts it in front.
class MemberReader {
 public:
  MemberReader(zip_t* archive, zip_uint64_t index) {
    zip_stat_init(&stat_);
    if (zip_stat_index(archive, index, 0, &stat_) != 0) throw Error(zip_strerror(archive));
    const bool plain = stat_.comp_method == ZIP_CM_STORE || stat_.comp_method == ZIP_CM_DEFLATE;
    if (!plain || stat_.encryption_method != ZIP_EM_NONE) {
      throw Error("is packed in a way that numpy does not use, expected stored or deflated");
    }
    if (stat_.size / kLargestDeflateRatio > stat_.comp_size) {
      throw Error(fmt::format("declares {} bytes in {} packed ones", stat_.size, stat_.comp_size));
    }
    member_.reset(zip_fopen_index(archive, index, 0));
    if (!member_) throw Error(zip_strerror(archive));
  }

  // `left`: of what all arrays may hold; less afterwards.
  NpzArray Read(std::size_t* left) {
    std::string header(std::min<std::size_t>(size(), kNpyPreamble), '\0');
    ReadBytes(header.data(), header.size());
    const std::size_t header_length = NpyHeaderLength(header);
    if (header_length > std::min(size(), kLargestNpyHeader)) {
      throw Error(fmt::format("declares a .npy header of {} bytes", header_length));
    }
    const std::size_t begun = header.size();
    header.resize(header_length);
    if (header_length > begun) ReadBytes(header.data() + begun, header_length - begun);

    const NpyHeader parsed = ParseNpyHeader(header);
    NpzArray array{parsed.type, parsed.shape, {}};
    const std::size_t expected = size() - header_length;
    const std::size_t bytes = BytesOfType(array.type);
    const std::optional<std::size_t> count = CountOfShape(array.shape);
    if (!count || expected % bytes != 0 || *count != expected / bytes) {
      throw Error(fmt::format("has the shape {} of type '{}' but {} bytes of values",
                              FormatShape(array.shape), array.type, expected));
    }
    if (*count > *left / sizeof(double)) {
      throw Error(fmt::format("has {} values, more than are read of a file of this size", *count));
    }
    *left -= *count * sizeof(double);
    array.data.resize(expected);
    ReadBytes(array.data.data(), expected);
    ExpectEnd();
    return array;
  }

 private:
  std::size_t size() const { return stat_.size; }

  void ReadBytes(void* bytes, std::size_t count) {
    const zip_int64_t got = zip_fread(member_.get(), bytes, count);
    if (got < 0) throw Error(fmt::format("is damaged: {}", zip_file_strerror(member_.get())));
    if (static_cast<std::size_t>(got) != count) throw Error("is cut short");
  }

  // The checksum is compared when the end is read.
  void ExpectEnd() {
    char beyond = 0;
    const zip_int64_t got = zip_fread(member_.get(), &beyond, 1);
    if (got < 0) throw Error(fmt::format("is damaged: {}", zip_file_strerror(member_.get())));
    if (got > 0) throw Error("is longer than declared");
  }

  zip_stat_t stat_;
  ZipHandle<zip_file_t> member_;
};

void ReadMember(zip_t* archive, zip_uint64_t index, std::size_t* left, Npz* arrays) {
  const char* const raw_name = zip_get_name(archive, index, ZIP_FL_ENC_RAW);
  const std::string_view file_name = raw_name ? raw_name : "";
  if (!file_name.ends_with(".npy")) {
    throw Error(fmt::format("member {} is not a .npy array", Quote(file_name)));
  }
  const std::string name(file_name.substr(0, file_name.size() - 4));
  if (arrays->contains(name)) throw Error(fmt::format("array {} is there twice", Quote(name)));
  try {
    arrays->emplace(name, MemberReader(archive, index).Read(left));
  } catch (const Error& error) {
    throw Error(fmt::format("array {} {}", Quote(name), error.what()));
  }
}

ZipHandle<zip_t> OpenArchive(const std::string& bytes) {
  ZipError error;
  ZipHandle<zip_source_t> source(
      zip_source_buffer_create(bytes.data(), bytes.size(), 0, error.get()));
  ZipHandle<zip_t> archive(
      source ? zip_open_from_source(source.get(), ZIP_RDONLY | ZIP_CHECKCONS, error.get())
             : nullptr);
  if (!archive) throw Error(fmt::format("is not a complete .npz archive: {}", error.text()));
  source.release();  // the archive owns it now
  return archive;
}

std::string MemberBytes(const NpzArray& array) {
  assert(array.data.size() == array.size() * BytesOfType(array.type));
  std::string bytes = FormatNpyHeader({array.type, array.shape});
  bytes.append(array.data.begin(), array.data.end());
  return bytes;
}

// Adds a member whose bytes must live until the archive is closed; false on failure.
bool AddMember(zip_t* archive, const std::string& file_name, const std::string& bytes,
               bool deflated) {
  zip_source_t* const source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
  if (!source) return false;
  const zip_int64_t added = zip_file_add(archive, file_name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (added < 0) {
    zip_source_free(source);
    return false;
  }
  constexpr zip_uint16_t kFirstOfJanuary1980 = 1 << 5 | 1;  // equal content gives equal bytes
  constexpr zip_uint32_t kLevel = 6;
  const zip_uint64_t index = static_cast<zip_uint64_t>(added);
  return zip_file_set_dostime(archive, index, 0, kFirstOfJanuary1980, 0) == 0 &&
         zip_set_file_compression(archive, index, deflated ? ZIP_CM_DEFLATE : ZIP_CM_STORE,
                                  kLevel) == 0;
}

// The bytes that were written to `source`.
std::string SourceBytes(zip_source_t* source) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_source_stat(source, &stat) != 0 || zip_source_open(source) != 0) return {};
  std::string bytes(stat.size, '\0');
  const zip_int64_t got = zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  return got == static_cast<zip_int64_t>(bytes.size()) ? bytes : std::string();
}

}  // namespace

Npz ParseNpz(const std::string& bytes, const std::string& path) {
  try {
    const ZipHandle<zip_t> archive = OpenArchive(bytes);
    const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
    if (count < 1) throw Error("holds no arrays");
    Npz arrays;
    std::size_t left = LargestContent(bytes.size());
    for (zip_int64_t i = 0; i < count; ++i) {
      ReadMember(archive.get(), static_cast<zip_uint64_t>(i), &left, &arrays);
    }
    return arrays;
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  } catch (const std::bad_alloc&) {
    throw Error(fmt::format("{}: holds more than there is memory for", path));
  }
}

Npz ReadNpz(const std::string& path) { return ParseNpz(ReadFile(path), path); }

std::string PackNpz(const Npz& arrays, const std::string& path) {
  const auto fail = [&path](const std::string& why) {
    throw Error(fmt::format("{}: cannot be packed: {}", path, why));
  };
  ZipError error;
  const ZipHandle<zip_source_t> source(zip_source_buffer_create(nullptr, 0, 0, error.get()));
  if (!source) fail(error.text());
  std::size_t content = 0;
  for (const auto& [name, array] : arrays) content += array.size() * sizeof(double);
  if (content > kLargestContent) {
    fail(fmt::format("holds {} bytes as doubles, more than are read", content));
  }
  const bool deflated = content <= kLargestOfSmallFile;  // else it might be packed too well to read
  ZipHandle<zip_t> archive(zip_open_from_source(source.get(), ZIP_TRUNCATE, error.get()));
  if (!archive) fail(error.text());
  zip_source_keep(source.get());  // shared with the archive from here on

  std::vector<std::string> members;  // alive until the archive is closed
  members.reserve(arrays.size());
  for (const auto& [name, array] : arrays) {
    members.push_back(MemberBytes(array));
    if (!AddMember(archive.get(), name + ".npy", members.back(), deflated)) {
      fail(zip_strerror(archive.get()));
    }
  }
  if (zip_close(archive.get()) != 0) fail(zip_strerror(archive.get()));
  archive.release();  // closed
  return SourceBytes(source.get());
}

void WriteNpz(const Npz& arrays, const std::string& path) {
  WriteFileAtomically(path, PackNpz(arrays, path));
}

std::string HashBytes(const std::string& bytes) {
  // FNV-1a, 64 bits
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

std::string HashFile(const std::string& path) { return HashBytes(ReadFile(path)); }

}  // namespace physpring
