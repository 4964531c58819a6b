// SPDX-License-Identifier: Apache-2.0
// What functions of Python do with the recordings that they are given.
#ifndef PHYSPRING_PYTHON_BINDINGS_GIVEN_RECORDINGS_H_
#define PHYSPRING_PYTHON_BINDINGS_GIVEN_RECORDINGS_H_

#include <string>
#include <vector>

#include "python/bindings/bindings.h"
#include "trainer/data/fit_data.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

using GivenRecordings = std::vector<const GivenRecording*>;

// Of arrays. Throws Error as ParseRecording does.
GivenRecording Given(RecordingEntry entry, Npz arrays);

// The same, as if it had been read from NAME.npz.
GivenRecording InMemory(const std::string& name, Npz arrays);

// To fit. Throws Error as CollectFitData does, and where none is given.
FitData FitDataOf(const GivenRecordings& given);

// By the twin's clock. Throws Error where there are clouds alone.
Recording RecordingFor(const Twin& twin, const GivenRecording& given);

// The warnings of `recording` that were not there when it was given, to `warnings`.
void AddNewWarnings(const GivenRecording& given, const Recording& recording,
                    std::vector<std::string>* warnings);

}  // namespace physpring

#endif  // PHYSPRING_PYTHON_BINDINGS_GIVEN_RECORDINGS_H_
