// SPDX-License-Identifier: Apache-2.0
// Values with units as people read them: in g, mm or mN where they are small, and with three
// digits. What unit a value has its key says: "mass_kg", "wind_x_m_per_s".
#ifndef PHYSPRING_REPORT_PICTURE_QUANTITY_H_
#define PHYSPRING_REPORT_PICTURE_QUANTITY_H_

#include <string>

namespace physpring {

// How values of a unit are written: times `factor`, in `unit`.
struct Scale {
  double factor = 1;
  std::string unit;
};

// For values up to `largest`, in an SI unit, radians, or "" for none.
Scale ScaleFor(const std::string& unit, double largest);

// About three digits, never with an exponent between 0.001 and a million.
std::string Digits(double value);

// Millimetres, with three digits, at most two of them behind the point: "12.3".
std::string InMm(double metres);

std::string FormatQuantity(double value, const std::string& unit);             // "12.3 g"
std::string FormatInterval(double low, double high, const std::string& unit);  // "11 to 14 g"
std::string UnitOfKey(const std::string& key);   // "kg/m" of "drag_kg_per_m"; "" if it has none
std::string LabelOfKey(const std::string& key);  // "wind x" of "wind_x_m_per_s"

std::string Capitalised(std::string sentence);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_PICTURE_QUANTITY_H_
