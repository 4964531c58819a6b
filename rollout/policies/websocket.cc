// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/websocket.h"

#include <fmt/format.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>

#include "rollout/policies/openpi_messages.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using tcp = asio::ip::tcp;

struct Address {
  std::string host, port, path;
};

// ws://HOST:PORT or ws://[HOST]:PORT, and /PATH behind it.
Address ParseAddress(const std::string& text) {
  constexpr std::string_view kScheme = "ws://", kDigits = "0123456789";
  constexpr std::size_t kNowhere = std::string::npos;
  const std::size_t path = text.find('/', kScheme.size());
  const std::string place = text.substr(0, path);
  const std::size_t colon = place.rfind(':');
  Address address{"", "", path == kNowhere ? "/" : text.substr(path)};
  if (text.starts_with(kScheme) && colon != kNowhere && colon > kScheme.size()) {
    address.host = place.substr(kScheme.size(), colon - kScheme.size());
    address.port = place.substr(colon + 1);
  }
  const bool bracketed = address.host.starts_with('[') && address.host.ends_with(']');
  if (bracketed) address.host = address.host.substr(1, address.host.size() - 2);
  const bool is_host =
      !address.host.empty() && (bracketed || address.host.find_first_of(":[]") == kNowhere);
  const bool is_port = !address.port.empty() && address.port.size() <= 5 &&
                       address.port.find_first_not_of(kDigits) == kNowhere;
  if (is_host && is_port) return address;
  throw Error(fmt::format("policy {}: expected ws://HOST:PORT", Quote(text)));
}

// A connection whose every operation ends within `patience` seconds, or throws PolicyError.
class Connection {
 public:
  Connection(const Address& address, double patience)
      : name_(address.host + ":" + address.port), patience_(patience), stream_(io_) {
    constexpr std::size_t kMostBytes = 1 << 28, kWriteBytes = 1 << 16;
    tcp::resolver resolver(io_);
    boost::system::error_code failure;
    const auto places = resolver.resolve(address.host, address.port, failure);
    if (failure) Fail(failure.message());
    Await([&](auto done) { stream_.next_layer().async_connect(places, done); });
    stream_.binary(true);
    stream_.auto_fragment(false);
    stream_.write_buffer_bytes(kWriteBytes);
    stream_.read_message_max(kMostBytes);
    Await([&](auto done) { stream_.async_handshake(name_, address.path, done); });
  }

  void Send(const std::string& message) {
    Await([&](auto done) { stream_.async_write(asio::buffer(message), done); });
  }

  std::string Receive() {
    beast::flat_buffer buffer;
    Await([&](auto done) { stream_.async_read(buffer, done); });
    std::string message(static_cast<const char*>(buffer.data().data()), buffer.size());
    if (stream_.got_text()) Fail("says " + Quote(message));  // openpi's servers tell errors so
    return message;
  }

 private:
  // Starts an operation with what is to be called at its end, and waits for that.
  template <class Start>
  void Await(const Start& start) {
    bool ended = false;
    boost::system::error_code failure;
    start([&](boost::system::error_code error, const auto&...) {
      ended = true;
      failure = error;
    });
    io_.restart();
    io_.run_for(std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(patience_)));
    if (!ended) {
      stream_.next_layer().close();
      io_.run();  // the operation's end, which refers to what is here
      Fail(fmt::format("does not answer within {} s", patience_));
    }
    if (failure) Fail(failure.message());
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw PolicyError(fmt::format("policy server {}: {}", name_, what));
  }

  std::string name_;
  double patience_;  // s
  asio::io_context io_;
  beast::websocket::stream<beast::tcp_stream> stream_;
};

class WebsocketPolicy : public Policy {
 public:
  WebsocketPolicy(const Task& task, const Address& address, double patience)
      : address_(address),
        patience_(patience),
        prompt_(task.prompt),
        numbers_(task.robot.action_size()) {}

  bool NeedsImages() const override { return next_ == actions_.cols(); }

  void Reset(std::uint64_t) override {
    next_ = 0;
    actions_.resize(numbers_, 0);
    connection_ = std::make_unique<Connection>(address_, patience_);
    CheckMetadata(connection_->Receive());
  }

  Eigen::VectorXd Act(const Observation& observation) override {
    if (next_ == actions_.cols()) {
      connection_->Send(EncodeObservation(observation, prompt_));
      actions_ = DecodeActions(connection_->Receive(), numbers_);
      next_ = 0;
    }
    return actions_.col(next_++);
  }

 private:
  Address address_;
  double patience_;  // s
  std::string prompt_;
  int numbers_;
  Eigen::MatrixXd actions_;  // numbers x frames
  Eigen::Index next_ = 0;
  std::unique_ptr<Connection> connection_;
};

}  // namespace

std::unique_ptr<Policy> MakeWebsocketPolicy(const Task& task, const std::string& address,
                                            double patience) {
  return std::make_unique<WebsocketPolicy>(task, ParseAddress(address), patience);
}

}  // namespace physpring
