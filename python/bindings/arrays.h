// SPDX-License-Identifier: Apache-2.0
// NumPy arrays and what they are here. Points are (N, 3) there and 3 x N, one column each, here:
// the same numbers in the same order.
#ifndef PHYSPRING_PYTHON_BINDINGS_ARRAYS_H_
#define PHYSPRING_PYTHON_BINDINGS_ARRAYS_H_

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <optional>
#include <string>
#include <vector>

#include "twin/npz.h"
#include "twin/points.h"

namespace physpring {

namespace nb = nanobind;

// Finite or not, C order, of this many dimensions. The Python side converts to these.
template <std::size_t kDimensions>
using Numbers = nb::ndarray<const double, nb::ndim<kDimensions>, nb::c_contig, nb::device::cpu>;
using NumpyDoubles = nb::ndarray<nb::numpy, double>;

// For properties that are arrays: these have their owner.
constexpr auto kHasOwner = nb::rv_policy::reference;

// Copies, owned by Python.
NumpyDoubles CopyOf(const Points& points);                // (N, 3)
NumpyDoubles CopyOf(const Eigen::VectorXd& numbers);      // (n)
NumpyDoubles CopyOf(const Eigen::MatrixXd& numbers);      // (rows, columns)
NumpyDoubles CopyOf(const std::vector<Points>& frames);   // (T, N, 3)
NumpyDoubles CopyOf(const std::vector<double>& numbers);  // (n)
nb::ndarray<nb::numpy, int> CopyOf(const std::vector<int>& numbers);
nb::object CopyOf(const NpzArray& array);  // of its own type

// A copy that nobody writes to, so that nobody takes it for a view.
nb::ndarray<nb::numpy, const int> FrozenCopyOf(const std::vector<int>& numbers);

// Views, which keep `owner` alive.
NumpyDoubles ViewOf(Points* points, nb::handle owner);            // (N, 3)
NumpyDoubles ViewOf(Eigen::VectorXd* numbers, nb::handle owner);  // (n)

// The other way round. Throw Error, "NAME ...", for another shape, or numbers that are not finite.
Points PointsFrom(const Numbers<2>& array, Eigen::Index columns, const char* name);
Eigen::VectorXd VectorFrom(const Numbers<1>& array, Eigen::Index size, const char* name);
// Of any number of frames.
std::vector<Points> FramesFrom(const Numbers<3>& array, Eigen::Index columns, const char* name);

// Of any type that files have. Throws Error for another one.
NpzArray NpzFrom(const nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>& array,
                 const std::string& name);

}  // namespace physpring

#endif  // PHYSPRING_PYTHON_BINDINGS_ARRAYS_H_
