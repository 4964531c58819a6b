// SPDX-License-Identifier: Apache-2.0
#include "twin/lowest_modes.h"

#include <Spectra/MatOp/SparseSymShiftSolve.h>
#include <Spectra/SymEigsShiftSolver.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace physpring {

Modes LowestModes(const Eigen::SparseMatrix<double>& laplacian, int count) {
  constexpr int kDense = 64;  // of fewer points all modes are computed
  const auto points = static_cast<int>(laplacian.cols());
  if (points >= kDense && 3 * count < points) {
    // the shift makes the matrix regular: its lowest eigenvalue is 0
    Spectra::SparseSymShiftSolve<double> operation(laplacian);
    Spectra::SymEigsShiftSolver<Spectra::SparseSymShiftSolve<double>> solver(
        operation, count, std::min(points, 3 * count), -1e-3 * laplacian.diagonal().mean());
    solver.init();
    const auto found = solver.compute(Spectra::SortRule::LargestMagn, 1000, 1e-10,
                                      Spectra::SortRule::SmallestAlge);
    if (found == count) return {solver.eigenvalues(), solver.eigenvectors()};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(laplacian)};
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace physpring
