// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/arrays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "twin/error.h"

namespace physpring {
namespace {

// An array that owns `numbers`; read-only if Kept is const.
template <class Number, class Kept = Number>
nb::ndarray<nb::numpy, Kept> Give(std::vector<Number> numbers, std::vector<std::size_t> shape) {
  auto kept = std::make_unique<std::vector<Number>>(std::move(numbers));
  Number* const data = kept->data();
  const nb::capsule owner(
      kept.release(), [](void* mine) noexcept { delete static_cast<std::vector<Number>*>(mine); });
  return nb::ndarray<nb::numpy, Kept>(data, shape.size(), shape.data(), owner);
}

template <std::size_t kDimensions>
std::string ShapeOf(const Numbers<kDimensions>& array) {
  std::vector<std::size_t> shape;
  for (std::size_t i = 0; i < kDimensions; ++i) shape.push_back(array.shape(i));
  return fmt::format("({})", fmt::join(shape, ", "));
}

template <std::size_t kDimensions>
void ExpectFinite(const Numbers<kDimensions>& array, const char* name) {
  const double* const end = array.data() + array.size();
  const double* const odd =
      std::find_if_not(array.data(), end, [](double number) { return std::isfinite(number); });
  if (odd == end) return;
  throw Error(fmt::format("{} has {} at its flat index {}, expected finite numbers", name, *odd,
                          odd - array.data()));
}

}  // namespace

NumpyDoubles CopyOf(const Points& points) {
  return Give(std::vector<double>(points.data(), points.data() + points.size()),
              {ExtentOf(points.cols()), 3});
}

NumpyDoubles CopyOf(const Eigen::VectorXd& numbers) {
  return Give(std::vector<double>(numbers.begin(), numbers.end()), {ExtentOf(numbers.size())});
}

NumpyDoubles CopyOf(const Eigen::MatrixXd& numbers) {
  const Eigen::MatrixXd transposed = numbers.transpose();  // rows first
  return Give(std::vector<double>(transposed.data(), transposed.data() + transposed.size()),
              {ExtentOf(numbers.rows()), ExtentOf(numbers.cols())});
}

NumpyDoubles CopyOf(const std::vector<double>& numbers) { return Give(numbers, {numbers.size()}); }

nb::ndarray<nb::numpy, int> CopyOf(const std::vector<int>& numbers) {
  return Give(numbers, {numbers.size()});
}

nb::ndarray<nb::numpy, const int> FrozenCopyOf(const std::vector<int>& numbers) {
  return Give<int, const int>(numbers, {numbers.size()});
}

NumpyDoubles CopyOf(const std::vector<Points>& frames) {
  const std::size_t columns = frames.empty() ? 0 : ExtentOf(frames[0].cols());
  std::vector<double> numbers;
  numbers.reserve(frames.size() * columns * 3);
  for (const Points& frame : frames) {
    numbers.insert(numbers.end(), frame.data(), frame.data() + frame.size());
  }
  return Give(std::move(numbers), {frames.size(), columns, 3});
}

nb::object CopyOf(const NpzArray& array) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::bytes bytes(array.data.data(), array.data.size());
  nb::list shape;
  for (const std::size_t extent : array.shape) shape.append(extent);
  return numpy.attr("frombuffer")(bytes, array.type.c_str())
      .attr("reshape")(nb::tuple(shape))
      .attr("copy")();
}

NumpyDoubles ViewOf(Points* points, nb::handle owner) {
  return NumpyDoubles(points->data(), {ExtentOf(points->cols()), 3}, owner);
}

NumpyDoubles ViewOf(Eigen::VectorXd* numbers, nb::handle owner) {
  return NumpyDoubles(numbers->data(), {ExtentOf(numbers->size())}, owner);
}

Points PointsFrom(const Numbers<2>& array, Eigen::Index columns, const char* name) {
  if (array.shape(0) != ExtentOf(columns) || array.shape(1) != 3) {
    throw Error(fmt::format("{} has shape {}, expected ({}, 3)", name, ShapeOf<2>(array), columns));
  }
  ExpectFinite<2>(array, name);
  return Eigen::Map<const Points>(array.data(), 3, columns);
}

Eigen::VectorXd VectorFrom(const Numbers<1>& array, Eigen::Index size, const char* name) {
  if (array.shape(0) != ExtentOf(size)) {
    throw Error(fmt::format("{} has shape {}, expected ({})", name, ShapeOf<1>(array), size));
  }
  ExpectFinite<1>(array, name);
  return Eigen::Map<const Eigen::VectorXd>(array.data(), size);
}

std::vector<Points> FramesFrom(const Numbers<3>& array, Eigen::Index columns, const char* name) {
  if (array.shape(1) != ExtentOf(columns) || array.shape(2) != 3 || array.shape(0) == 0) {
    throw Error(
        fmt::format("{} has shape {}, expected (frames, {}, 3)", name, ShapeOf<3>(array), columns));
  }
  ExpectFinite<3>(array, name);
  std::vector<Points> frames;
  for (std::size_t t = 0; t < array.shape(0); ++t) {
    frames.emplace_back(
        Eigen::Map<const Points>(array.data() + t * ExtentOf(3 * columns), 3, columns));
  }
  return frames;
}

NpzArray NpzFrom(const nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>& array,
                 const std::string& name) {
  const nb::dlpack::dtype type = array.dtype();
  const auto code = static_cast<nb::dlpack::dtype_code>(type.code);
  char kind = 0;
  if (code == nb::dlpack::dtype_code::Float) kind = 'f';
  if (code == nb::dlpack::dtype_code::Int) kind = 'i';
  if (code == nb::dlpack::dtype_code::UInt) kind = 'u';
  if (code == nb::dlpack::dtype_code::Bool) kind = 'b';
  const int bytes = type.bits / 8;
  const bool known = kind == 'f' ? bytes == 2 || bytes == 4 || bytes == 8 : kind != 0 && bytes <= 8;
  if (!known) throw Error(fmt::format("array '{}' is not of numbers or truth values", name));
  NpzArray result;
  result.type = fmt::format("{}{}{}", bytes == 1 ? '|' : '<', kind, bytes);
  for (std::size_t i = 0; i < array.ndim(); ++i) result.shape.push_back(array.shape(i));
  result.data.resize(array.nbytes());
  if (!result.data.empty()) std::memcpy(result.data.data(), array.data(), array.nbytes());
  return result;
}

}  // namespace physpring
