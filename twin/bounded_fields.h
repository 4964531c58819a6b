// SPDX-License-Identifier: Apache-2.0
// Numbers of a JSON object that must lie within bounds.
#ifndef PHYSPRING_TWIN_BOUNDED_FIELDS_H_
#define PHYSPRING_TWIN_BOUNDED_FIELDS_H_

#include <string>
#include <vector>

#include "twin/json_fields.h"

namespace physpring {

// Each throws Error unless the key holds that, within the bounds; those with a default take it
// where the key is missing.
double NumberBetween(const JsonFields& fields, const std::string& key, double least, double most);
std::vector<double> NumbersBetween(const JsonFields& fields, const std::string& key, double least,
                                   double most);
double PositiveNumber(const JsonFields& fields, const std::string& key, double most);
double PositiveNumberOr(const JsonFields& fields, const std::string& key, double missing,
                        double most);
int CountBetween(const JsonFields& fields, const std::string& key, int least, int most);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_BOUNDED_FIELDS_H_
