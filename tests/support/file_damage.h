// SPDX-License-Identifier: Apache-2.0
// Readers under damage: an error must be one line that begins with the path, and a damaged file
// must never be taken for a different sound one.
#ifndef PHYSPRING_TESTS_SUPPORT_FILE_DAMAGE_H_
#define PHYSPRING_TESTS_SUPPORT_FILE_DAMAGE_H_

#include <functional>
#include <random>
#include <string>

#include "twin/npz.h"

namespace physpring {

// The message of the Error that `action` throws; "" with a test failure if it throws none, if the
// message is not one line, or if it does not begin with `path` and ": ".
std::string ErrorOf(const std::string& path, const std::function<void()>& action);

// A test failure unless `message` is one line that begins with `path` and ": ".
void ExpectOneLine(const std::string& path, const std::string& message);

// Writes a file without care: thousands of damaged ones need no sync to the disk.
void Overwrite(const std::string& path, const std::string& bytes);

// Changes one to three things: an array is gone, or has another name, shape, type, or value.
void MutateArrays(Npz& arrays, std::mt19937& random);

bool operator==(const NpzArray& a, const NpzArray& b);

// Cuts the .npz file at `path` at every byte, changes every byte of it, once all its bits and once
// one of them, and calls `read` each time. Every cut must be refused with such an error. A change
// must be, too, unless all arrays are still what they were (a byte that says nothing about them, as
// a date).
void ExpectEveryDamageIsRefused(const std::string& path, const std::function<void()>& read);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_FILE_DAMAGE_H_
