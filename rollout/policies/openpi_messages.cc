// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/openpi_messages.h"

#include <fmt/format.h>

#include <cstring>
#include <msgpack.hpp>
#include <vector>

#include "rollout/picture_size.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Packer = msgpack::packer<msgpack::sbuffer>;

void PackBytes(const void* bytes, std::size_t size, Packer* packer) {
  packer->pack_bin(static_cast<std::uint32_t>(size));
  packer->pack_bin_body(static_cast<const char*>(bytes), static_cast<std::uint32_t>(size));
}

void PackKey(const char* key, Packer* packer) { PackBytes(key, std::strlen(key), packer); }

void PackArray(const void* data, std::size_t bytes, const char* type, const std::vector<int>& shape,
               Packer* packer) {
  packer->pack_map(4);
  PackKey("__ndarray__", packer);
  packer->pack_true();
  PackKey("data", packer);
  PackBytes(data, bytes, packer);
  PackKey("dtype", packer);
  packer->pack(std::string(type));
  PackKey("shape", packer);
  packer->pack(shape);
}

void PackImage(const ImageField& field, const Image& seen, Packer* packer) {
  Image image = field.mirror ? Mirror(seen) : seen;
  if (field.width > 0) image = ResizeWithPad(image, field.width, field.height);
  if (!field.colours_first) {
    PackArray(image.rgb.data(), image.rgb.size(), "|u1", {image.height, image.width, 3}, packer);
    return;
  }
  const std::size_t pixels = image.rgb.size() / 3;
  std::vector<unsigned char> planes(image.rgb.size());
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t colour = 0; colour < 3; ++colour) {
      planes[colour * pixels + i] = image.rgb[3 * i + colour];
    }
  }
  PackArray(planes.data(), planes.size(), "|u1", {3, image.height, image.width}, packer);
}

// What a request is made of.
struct Asked {
  const PolicyFrames& frames;
  const Observation& observation;
  const std::string& prompt;
};

void PackFields(const std::vector<RequestField>& fields, const Asked& asked, Packer* packer) {
  packer->pack_map(static_cast<std::uint32_t>(fields.size()));
  for (const RequestField& field : fields) {
    packer->pack(field.key);
    if (field.is_prompt) {
      packer->pack(asked.prompt);
    } else if (field.image) {
      PackImage(*field.image, asked.observation.images.at(field.image->camera), packer);
    } else if (!field.state.empty()) {
      std::vector<double> state;
      for (const StatePart& part : field.state) {
        AddState(part, asked.observation, asked.frames, &state);
      }
      PackArray(state.data(), sizeof(double) * state.size(), "<f8",
                {static_cast<int>(state.size())}, packer);
    } else {
      PackFields(field.fields, asked, packer);
    }
  }
}

// Counts what a message holds before anything is made of it: an object takes 24 bytes, and the
// shortest one only 1 in the message.
class ItemCounter : public msgpack::null_visitor {
 public:
  bool start_array(std::uint32_t items) { return Enter(items); }
  bool start_map(std::uint32_t items) { return Enter(2 * std::uint64_t{items}); }
  bool end_array() { return Leave(); }
  bool end_map() { return Leave(); }
  void parse_error(std::size_t, std::size_t) { malformed_ = true; }
  void insufficient_bytes(std::size_t, std::size_t) { malformed_ = true; }

  bool malformed() const { return malformed_; }

 private:
  static constexpr std::uint64_t kMostItems = 1 << 16;
  static constexpr int kDeepest = 16;

  bool Enter(std::uint64_t items) {
    items_ += items;
    ++depth_;
    return items_ <= kMostItems && depth_ <= kDeepest;
  }
  bool Leave() {
    --depth_;
    return true;
  }

  std::uint64_t items_ = 0;
  int depth_ = 0;
  bool malformed_ = false;
};

// Objects refer to `message`, which must live as long.
msgpack::object_handle Unpack(std::string_view message) {
  ItemCounter counter;
  std::size_t end = 0;
  if (!msgpack::parse(message.data(), message.size(), end, counter)) {
    throw PolicyServerError(counter.malformed() ? "the policy server's message is not msgpack"
                                                : "the policy server's message has too many items");
  }
  const auto refer = [](msgpack::type::object_type, std::size_t, void*) { return true; };
  try {
    return msgpack::unpack(message.data(), message.size(), refer);
  } catch (const msgpack::unpack_error& error) {
    throw PolicyServerError(
        fmt::format("the policy server's message is not msgpack: {}", error.what()));
  }
}

// Text or bytes.
std::string_view Text(const msgpack::object& object) {
  if (object.type == msgpack::type::STR) return {object.via.str.ptr, object.via.str.size};
  if (object.type == msgpack::type::BIN) return {object.via.bin.ptr, object.via.bin.size};
  return {};
}

// The value of a key of a map, or null.
const msgpack::object* Find(const msgpack::object& map, std::string_view key) {
  if (map.type != msgpack::type::MAP) return nullptr;
  for (std::uint32_t i = 0; i < map.via.map.size; ++i) {
    if (Text(map.via.map.ptr[i].key) == key) return &map.via.map.ptr[i].val;
  }
  return nullptr;
}

// Little-endian numbers as doubles, whatever their alignment.
template <class Number>
std::vector<double> NumbersOf(std::string_view bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(Number));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Number number;
    std::memcpy(&number, bytes.data() + i * sizeof(Number), sizeof(Number));
    numbers[i] = static_cast<double>(number);
  }
  return numbers;
}

// Of an array of up to 4 dimensions; none for all else.
std::vector<std::uint64_t> Shape(const msgpack::object& object) {
  constexpr std::uint32_t kMostDimensions = 4;
  std::vector<std::uint64_t> shape;
  if (object.type != msgpack::type::ARRAY || object.via.array.size > kMostDimensions) return shape;
  for (std::uint32_t i = 0; i < object.via.array.size; ++i) {
    const msgpack::object& extent = object.via.array.ptr[i];
    if (extent.type != msgpack::type::POSITIVE_INTEGER) return {};
    shape.push_back(extent.via.u64);
  }
  return shape;
}

}  // namespace

std::string EncodeObservation(const PolicyAdapter& adapter, const Observation& observation,
                              const std::string& prompt) {
  msgpack::sbuffer buffer;
  Packer packer(buffer);
  PackFields(adapter.request, {adapter.frames, observation, prompt}, &packer);
  return {buffer.data(), buffer.size()};
}

Eigen::MatrixXd DecodeActions(std::string_view message, int numbers) {
  const msgpack::object_handle answer = Unpack(message);
  const msgpack::object* actions = Find(answer.get(), "actions");
  if (!actions) throw PolicyServerError("the policy server's answer has no actions");
  const msgpack::object* data = Find(*actions, "data");
  const msgpack::object* type = Find(*actions, "dtype");
  const msgpack::object* extents = Find(*actions, "shape");
  if (!Find(*actions, "__ndarray__") || !data || !type || !extents) {
    throw PolicyServerError("the policy server's actions are no NumPy array");
  }
  std::vector<double> values;
  if (Text(*type) == "<f4") {
    values = NumbersOf<float>(Text(*data));
  } else if (Text(*type) == "<f8") {
    values = NumbersOf<double>(Text(*data));
  } else {
    throw PolicyServerError(fmt::format(
        "the policy server's actions are of type {}, expected <f4 or <f8", Quote(Text(*type))));
  }
  const std::vector<std::uint64_t> shape = Shape(*extents);
  const auto size = static_cast<std::uint64_t>(numbers);
  if (shape.size() != 2 || shape[0] == 0 || shape[0] > values.size() || shape[1] != size ||
      shape[0] * shape[1] != values.size()) {
    throw PolicyError(fmt::format("the policy server's actions have shape ({}), expected (n, {})",
                                  fmt::join(shape, ", "), numbers));
  }
  return Eigen::Map<const Eigen::MatrixXd>(values.data(), numbers,
                                           static_cast<Eigen::Index>(shape[0]));
}

void CheckMetadata(std::string_view message) {
  const msgpack::object_handle metadata = Unpack(message);
  if (metadata.get().type == msgpack::type::MAP) return;
  throw PolicyServerError("the policy server does not begin with metadata, as openpi's do");
}

}  // namespace physpring
