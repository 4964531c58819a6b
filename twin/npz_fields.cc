// SPDX-License-Identifier: Apache-2.0
#include "twin/npz_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "twin/error.h"
#include "twin/npy.h"

namespace physpring {
namespace {

constexpr double kFarthest = 1000;  // m, of a coordinate from 0
constexpr std::size_t kMostFrames = std::size_t{1} << 22;

bool IsNumber(const std::string& extent) {
  return std::all_of(extent.begin(), extent.end(), [](unsigned char c) { return std::isdigit(c); });
}

// "(T, N, 3) with T = 120", naming the symbols whose size is known.
std::string FormatExtents(const Extents& shape, const std::map<std::string, std::size_t>& known) {
  std::string sizes;
  for (const std::string& extent : shape) {
    const auto size = known.find(extent);
    if (size == known.end()) continue;
    sizes += fmt::format("{}{} = {}", sizes.empty() ? " with " : ", ", extent, size->second);
  }
  return fmt::format("({}{}){}", fmt::join(shape, ", "), shape.size() == 1 ? "," : "", sizes);
}

// "[3, 0, 2]": the place of a flat index in C order.
std::string FormatIndex(std::size_t index, const std::vector<std::size_t>& shape) {
  std::vector<std::size_t> place(shape.size());
  for (std::size_t i = shape.size(); i-- > 0;) {
    place[i] = index % shape[i];
    index /= shape[i];
  }
  return fmt::format("[{}]", fmt::join(place, ", "));
}

}  // namespace

double NpzFields::Scalar(const std::string& name) { return FiniteNumbers(name, {})[0]; }

Eigen::VectorXd NpzFields::Vector(const std::string& name, const std::string& size) {
  const std::vector<double> values = FiniteNumbers(name, {size});
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::MatrixXd NpzFields::Matrix(const std::string& name, const std::string& rows,
                                  const std::string& columns) {
  using RowsFirst = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::vector<double> values = FiniteNumbers(name, {rows, columns});
  return Eigen::Map<const RowsFirst>(values.data(), static_cast<Eigen::Index>(Extent(rows)),
                                     static_cast<Eigen::Index>(Extent(columns)));
}

Points NpzFields::Positions(const std::string& name, const std::string& size) {
  const std::vector<double> values = FiniteNumbers(name, {size, "3"});
  ExpectWithinReach(name, values.data(), values.size(), 0);
  return Eigen::Map<const Points>(values.data(), 3, static_cast<Eigen::Index>(values.size() / 3));
}

std::vector<Points> NpzFields::FramesWithUnseen(const std::string& name, const std::string& size,
                                                const std::string& frames) {
  GetNumbers(name, {frames, size, "3"});
  if (Extent(size) < 1) Fail(name, "has no points, expected at least one");
  return SplitFrames(name, &NpzFields::ExpectFiniteOrUnseen);
}

std::vector<Points> NpzFields::Frames(const std::string& name, const std::string& size,
                                      const std::string& frames) {
  GetNumbers(name, {frames, size, "3"});
  return SplitFrames(name, &NpzFields::ExpectFinite);
}

std::vector<Eigen::MatrixXd> NpzFields::FramesOfNumbers(const std::string& name,
                                                        const std::string& size,
                                                        const std::string& frames) {
  const bool vectors = Get(name).shape.size() == 3;
  const NpzArray& array =
      GetNumbers(name, vectors ? Extents{frames, size, "3"} : Extents{frames, size});
  ExpectFewFrames(name, array.shape[0]);
  const Eigen::Index rows = vectors ? 3 : 1;
  const std::size_t numbers = static_cast<std::size_t>(rows) * array.shape[1];
  std::vector<Eigen::MatrixXd> split;
  for (std::size_t t = 0; t < array.shape[0]; ++t) {
    Eigen::MatrixXd& frame = split.emplace_back(rows, static_cast<Eigen::Index>(array.shape[1]));
    array.CopyDoubles(t * numbers, numbers, frame.data());
    if (!frame.array().isInf().any()) continue;
    Fail(name, fmt::format("holds an infinite number in frame {}, expected finite ones, or NaN for "
                           "what was not measured",
                           t));
  }
  return split;
}

void NpzFields::ExpectFewFrames(const std::string& name, std::size_t frames) const {
  if (frames <= kMostFrames) return;
  Fail(name, fmt::format("has {} frames, expected at most {}", frames, kMostFrames));
}

std::vector<Points> NpzFields::SplitFrames(const std::string& name, CheckFrame check) const {
  const NpzArray& array = Get(name);
  const std::size_t frames = array.shape[0], numbers = 3 * array.shape[1];
  ExpectFewFrames(name, frames);
  std::vector<Points> split;
  split.reserve(frames);
  for (std::size_t t = 0; t < frames; ++t) {
    Points& frame = split.emplace_back(3, static_cast<Eigen::Index>(array.shape[1]));
    array.CopyDoubles(t * numbers, numbers, frame.data());
    (this->*check)(name, frame, t);
    ExpectWithinReach(name, frame.data(), numbers, t * numbers);
  }
  return split;
}

void NpzFields::ExpectFinite(const std::string& name, const Points& frame, std::size_t t) const {
  const auto numbers = static_cast<std::size_t>(frame.size());
  ExpectFinite(name, frame.data(), numbers, t * numbers);
}

void NpzFields::ExpectFiniteOrUnseen(const std::string& name, const Points& frame,
                                     std::size_t t) const {
  for (Eigen::Index i = 0; i < frame.cols(); ++i) {
    const auto count = frame.col(i).array().isNaN().count();
    if (count == 3) continue;
    if (count > 0) {
      Fail(name, fmt::format("holds a point that is partly NaN at [{}, {}], expected all three "
                             "coordinates, or three NaN for a point not seen",
                             t, i));
    }
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (!std::isinf(frame(k, i))) continue;
      Fail(name, fmt::format("holds {} at [{}, {}, {}], expected finite numbers, or NaN for a "
                             "point not seen",
                             frame(k, i), t, i, k));
    }
  }
}

Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> NpzFields::Flags(const std::string& name,
                                                                    const std::string& rows,
                                                                    const std::string& columns) {
  const NpzArray& array = GetOfShape(name, {rows, columns});
  ExpectFewFrames(name, array.shape[0]);
  const std::vector<double> values = array.ToDoubles();
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> flags(
      static_cast<Eigen::Index>(array.shape[0]), static_cast<Eigen::Index>(array.shape[1]));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] != 0 && values[i] != 1) {
      Fail(name,
           fmt::format("holds {} at {}, expected 0 or 1", values[i], FormatIndex(i, array.shape)));
    }
    const auto at = static_cast<Eigen::Index>(i);
    flags(at / flags.cols(), at % flags.cols()) = values[i] == 1;
  }
  return flags;
}

std::vector<int> NpzFields::Ints(const std::string& name, const Extents& shape) {
  const NpzArray& array = GetOfShape(name, shape);
  if (array.type == "|b1") Fail(name, "has the type '|b1', expected whole numbers");
  try {
    return array.ToInts();
  } catch (const Error& error) {
    Fail(name, error.what());
  }
}

std::string NpzFields::Text(const std::string& name) const {
  const NpzArray& array = Get(name);
  try {
    return array.ToText();
  } catch (const Error& error) {
    Fail(name, error.what());
  }
}

void NpzFields::Fail(const std::string& name, const std::string& what) const {
  Fail(fmt::format("array '{}' {}", name, what));
}

void NpzFields::Fail(const std::string& what) const {
  throw Error(fmt::format("{}: {}", path_, what));
}

const NpzArray& NpzFields::Get(const std::string& name) const {
  const auto found = arrays_.find(name);
  if (found == arrays_.end()) Fail(name, "is missing");
  return found->second;
}

const NpzArray& NpzFields::GetOfShape(const std::string& name, const Extents& shape) {
  const NpzArray& array = Get(name);
  const std::map<std::string, std::size_t> known = extents_;
  bool agrees = array.shape.size() == shape.size();
  for (std::size_t i = 0; agrees && i < shape.size(); ++i) {
    const std::size_t expected = IsNumber(shape[i])
                                     ? std::stoul(shape[i])
                                     : extents_.emplace(shape[i], array.shape[i]).first->second;
    agrees = array.shape[i] == expected;
  }
  if (!agrees) {
    Fail(name, fmt::format("has the shape {}, expected {}", FormatShape(array.shape),
                           FormatExtents(shape, known)));
  }
  return array;
}

const NpzArray& NpzFields::GetNumbers(const std::string& name, const Extents& shape) {
  const NpzArray& array = GetOfShape(name, shape);
  if (array.type == "|b1") Fail(name, "has the type '|b1', expected numbers");
  return array;
}

std::vector<double> NpzFields::FiniteNumbers(const std::string& name, const Extents& shape) {
  std::vector<double> values = GetNumbers(name, shape).ToDoubles();
  ExpectFinite(name, values.data(), values.size(), 0);
  return values;
}

void NpzFields::ExpectFinite(const std::string& name, const double* values, std::size_t count,
                             std::size_t first) const {
  const double* const end = values + count;
  const double* const bad = std::find_if(values, end, [](double x) { return !std::isfinite(x); });
  if (bad == end) return;
  const std::vector<std::size_t>& shape = Get(name).shape;
  const std::size_t index = first + static_cast<std::size_t>(bad - values);
  const std::string place = shape.empty() ? "" : " at " + FormatIndex(index, shape);
  Fail(name, fmt::format("holds {}{}, expected finite numbers", *bad, place));
}

void NpzFields::ExpectWithinReach(const std::string& name, const double* coordinates,
                                  std::size_t count, std::size_t first) const {
  const auto is_far = [](double value) { return std::abs(value) > kFarthest; };
  const double* const far = std::find_if(coordinates, coordinates + count, is_far);
  if (far == coordinates + count) return;
  const std::size_t place = first + static_cast<std::size_t>(far - coordinates);
  Fail(name, fmt::format("holds {} at {}, expected coordinates within {} m; NaN stands for a point "
                         "that is not seen",
                         *far, FormatIndex(place, Get(name).shape), kFarthest));
}

NpzArray StoreFrames(const std::vector<Points>& frames) {
  const Eigen::Index columns = frames.empty() ? 0 : frames[0].cols();
  std::vector<double> values;
  values.reserve(frames.size() * ExtentOf(3 * columns));
  for (const Points& frame : frames) {
    if (frame.cols() != columns) throw Error("frames differ in their number of points");
    values.insert(values.end(), frame.data(), frame.data() + frame.size());
  }
  return NpzArray::Floats({frames.size(), ExtentOf(columns), 3}, values.data());
}

}  // namespace physpring
