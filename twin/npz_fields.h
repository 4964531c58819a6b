// SPDX-License-Identifier: Apache-2.0
// The arrays of one file by name, with their shapes and values checked. Every message is one line
// that names file, array, what it holds and what is expected.
#ifndef PHYSPRING_TWIN_NPZ_FIELDS_H_
#define PHYSPRING_TWIN_NPZ_FIELDS_H_

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "twin/npz.h"
#include "twin/points.h"

namespace physpring {

// Extents of a shape: numbers ("3") or symbols ("T"). A symbol stands for any size where it is
// first met, and for that size ever after.
using Extents = std::vector<std::string>;

class NpzFields {
 public:
  // `arrays` must live as long as this object; messages begin with `path`.
  NpzFields(const Npz& arrays, std::string path) : arrays_(arrays), path_(std::move(path)) {}

  const std::string& path() const { return path_; }

  bool Has(const std::string& name) const { return arrays_.contains(name); }

  // Fixes the size of a symbol, or tells it.
  void SetExtent(const std::string& symbol, std::size_t size) { extents_[symbol] = size; }
  std::size_t Extent(const std::string& symbol) const { return extents_.at(symbol); }

  // Finite numbers: a scalar, one dimension, and (size, 3) as 3 x size.
  double Scalar(const std::string& name);
  Eigen::VectorXd Vector(const std::string& name, const std::string& size);
  // (rows, columns).
  Eigen::MatrixXd Matrix(const std::string& name, const std::string& rows,
                         const std::string& columns);
  // Coordinates, here and below, are within 1 km of 0: what is farther off marks a lost point, or
  // overflows in squares.
  Points Positions(const std::string& name, const std::string& size);

  // (T, size, 3) as T frames of 3 x size, at most 2^22 of them. `frames`: a symbol for T. There are
  // one or more points, which may be NaN in all three coordinates, not in some.
  std::vector<Points> FramesWithUnseen(const std::string& name, const std::string& size,
                                       const std::string& frames = "T");
  // The same, all finite; there may be no points.
  std::vector<Points> Frames(const std::string& name, const std::string& size,
                             const std::string& frames = "T");
  // (frames, size, 3) or (frames, size) as frames of 3 x size or 1 x size, at most 2^22 of them, of
  // numbers that are finite or NaN.
  std::vector<Eigen::MatrixXd> FramesOfNumbers(const std::string& name, const std::string& size,
                                               const std::string& frames);

  // (rows, columns) of truth values, or of 0 and 1.
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> Flags(const std::string& name,
                                                           const std::string& rows,
                                                           const std::string& columns);

  // Whole numbers, C order.
  std::vector<int> Ints(const std::string& name, const Extents& shape);

  // The text of an array of bytes.
  std::string Text(const std::string& name) const;

  // Throws Error: "PATH: array 'NAME' WHAT", "PATH: WHAT".
  [[noreturn]] void Fail(const std::string& name, const std::string& what) const;
  [[noreturn]] void Fail(const std::string& what) const;

 private:
  const NpzArray& Get(const std::string& name) const;
  void ExpectFewFrames(const std::string& name, std::size_t frames) const;
  const NpzArray& GetOfShape(const std::string& name, const Extents& shape);
  const NpzArray& GetNumbers(const std::string& name, const Extents& shape);
  std::vector<double> FiniteNumbers(const std::string& name, const Extents& shape);
  // Frame by frame, so that no second copy of all is made; `check` sees a frame and its number.
  using CheckFrame = void (NpzFields::*)(const std::string&, const Points&, std::size_t) const;
  std::vector<Points> SplitFrames(const std::string& name, CheckFrame check) const;
  void ExpectFinite(const std::string& name, const Points& frame, std::size_t t) const;
  void ExpectFiniteOrUnseen(const std::string& name, const Points& frame, std::size_t t) const;
  // `first`: the flat index of the first of these values in the array.
  void ExpectFinite(const std::string& name, const double* values, std::size_t count,
                    std::size_t first) const;
  void ExpectWithinReach(const std::string& name, const double* coordinates, std::size_t count,
                         std::size_t first) const;

  const Npz& arrays_;
  std::string path_;
  std::map<std::string, std::size_t> extents_;
};

// The frames (T of 3 x columns, m) as an array (T, columns, 3) of floats: what Frames reads. Throws
// Error if they differ in their number of columns.
NpzArray StoreFrames(const std::vector<Points>& frames);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_NPZ_FIELDS_H_
