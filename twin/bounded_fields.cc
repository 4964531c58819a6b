// SPDX-License-Identifier: Apache-2.0
#include "twin/bounded_fields.h"

#include <fmt/format.h>

namespace physpring {

std::vector<double> NumbersBetween(const JsonFields& fields, const std::string& key, double least,
                                   double most) {
  std::vector<double> numbers = fields.Numbers(key);
  for (const double number : numbers) {
    if (number >= least && number <= most) continue;
    fields.Fail(key, fmt::format("holds {}, expected numbers from {} to {}", number, least, most));
  }
  return numbers;
}

double NumberBetween(const JsonFields& fields, const std::string& key, double least, double most) {
  const double number = fields.Number(key);
  if (number >= least && number <= most) return number;
  fields.Fail(key, fmt::format("holds {}, expected {} to {}", number, least, most));
}

double PositiveNumber(const JsonFields& fields, const std::string& key, double most) {
  const double number = fields.Number(key);
  if (number > 0 && number <= most) return number;
  fields.Fail(key, fmt::format("holds {}, expected more than 0, at most {}", number, most));
}

double PositiveNumberOr(const JsonFields& fields, const std::string& key, double missing,
                        double most) {
  return fields.Has(key) ? PositiveNumber(fields, key, most) : missing;
}

int CountBetween(const JsonFields& fields, const std::string& key, int least, int most) {
  const int count = fields.Count(key);
  if (count >= least && count <= most) return count;
  fields.Fail(key, fmt::format("holds {}, expected {} to {}", count, least, most));
}

}  // namespace physpring
