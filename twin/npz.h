// SPDX-License-Identifier: Apache-2.0
// NumPy archives (.npz): a zip of .npy members, stored or deflated.
#ifndef PHYSPRING_TWIN_NPZ_H_
#define PHYSPRING_TWIN_NPZ_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace physpring {

// A count, as an extent of an array.
inline std::size_t ExtentOf(std::ptrdiff_t count) { return static_cast<std::size_t>(count); }

// One array, C order, little endian.
struct NpzArray {
  std::string type;                 // numpy type: <f2 <f4 <f8 |i1 <i2 <i4 <i8 |u1 <u2 <u4 <u8 |b1
  std::vector<std::size_t> shape;   // empty: a scalar
  std::vector<unsigned char> data;  // size() * bytes of the type

  std::size_t size() const;

  static NpzArray Doubles(std::vector<std::size_t> shape, const double* values);
  static NpzArray Floats(std::vector<std::size_t> shape, const double* values);  // stored as f4
  static NpzArray Ints(std::vector<std::size_t> shape, const int* values);
  static NpzArray Text(const std::string& text);  // "|u1" (bytes)

  // Values as double, int or text. Throw Error (without a path) when the values have no such
  // meaning: ToInts takes whole numbers that fit, of any type; ToText bytes in one dimension.
  std::vector<double> ToDoubles() const;
  void CopyDoubles(std::size_t first, std::size_t count, double* values) const;  // some of them
  std::vector<int> ToInts() const;
  std::string ToText() const;
};

using Npz = std::map<std::string, NpzArray>;  // by name, without ".npy"

// Throws Error (one line, beginning with the path) when the file is not readable, not a zip, cut
// short, damaged (checksum), has a member that is not a .npy array, or an array of objects, of
// Fortran order with more than one dimension, of big endian, or whose size and shape disagree. What
// all arrays would take as doubles is counted before memory is taken for them: more than 4 GiB is
// refused, and more than 256 MiB and 64 times the file.
Npz ReadNpz(const std::string& path);

// The same for a file already in memory; `path` only begins the messages.
Npz ParseNpz(const std::string& bytes, const std::string& path);

// Writes atomically (temporary file in the same folder, fsync, rename, fsync of the folder). Equal
// content gives equal bytes. Throws Error when the disk is full or the folder not writable; then a
// file that was there before is untouched and no temporary file is left. Arrays are deflated unless
// they take more than 256 MiB as doubles.
void WriteNpz(const Npz& arrays, const std::string& path);

// The bytes that WriteNpz writes; `path` only begins the messages.
std::string PackNpz(const Npz& arrays, const std::string& path);

// 64-bit hash of a file's content as 16 hex digits (for telling recordings apart).
std::string HashBytes(const std::string& bytes);
std::string HashFile(const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_NPZ_H_
