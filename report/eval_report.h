// SPDX-License-Identifier: Apache-2.0
// What `physpring eval` prints and writes. In JSON (docs/eval.md), lengths are in metres, and a
// mean without data is null.
#ifndef PHYSPRING_REPORT_EVAL_REPORT_H_
#define PHYSPRING_REPORT_EVAL_REPORT_H_

#include <optional>
#include <string>

#include "report/evaluation.h"

namespace physpring {

// A length in metres as tables have it: millimetres with two digits, "-" where there is none.
std::string Millimetres(const std::optional<double>& metres);

// A table for each recording and, if there are several, one of their means. Ends with a newline.
std::string FormatTables(const Evaluation& evaluation);

// The JSON document, ending with a newline.
std::string FormatJson(const Evaluation& evaluation);

// Writes levelN/points (T, N, 3): the measured points as predicted by each level, in all frames.
// `path` is the file if it ends with ".npz" (one recording only), else a folder for NAME.npz of
// each recording; it is made if missing. Throws Error before anything is written if `path` does not
// suit the recordings or cannot be made.
void WriteTrajectories(const Evaluation& evaluation, const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_EVAL_REPORT_H_
