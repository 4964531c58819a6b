// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/websocket.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <queue>
#include <thread>
#include <utility>

#include "rollout/policies/openpi_messages.h"
#include "twin/error.h"
#include "twin/quote.h"
#include "twin/stop_request.h"

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
  constexpr int kMostPort = 65535;
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
                       address.port.find_first_not_of(kDigits) == kNowhere &&
                       std::stoi(address.port) <= kMostPort;
  if (is_host && is_port) return address;
  throw Error(fmt::format("policy {}: expected ws://HOST:PORT", Quote(text)));
}

// The last line of what a server says; of a traceback the one that says what happened.
std::string LastLine(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos) return "";
  const std::size_t start = text.find_last_of('\n', end);
  return text.substr(start == std::string::npos ? 0 : start + 1, end - (start + 1) + 1);
}

using Seconds = std::chrono::duration<double>;

// A connection to a server. It always reads, in a thread of its own, so that the server's pings are
// answered while a chunk of actions is simulated. All that goes wrong with it throws
// PolicyServerError.
class Connection {
 public:
  Connection(const Address& address, const ServerPatience& patience)
      : name_(address.host + ":" + address.port), patience_(patience), stream_(io_) {
    constexpr std::size_t kMostBytes = 1 << 24, kWriteBytes = 1 << 16;
    Connect(address);
    stream_.binary(true);
    stream_.auto_fragment(false);
    stream_.write_buffer_bytes(kWriteBytes);
    stream_.read_message_max(kMostBytes);
    const auto failure =
        Await([&](auto done) { stream_.async_handshake(name_, address.path, done); });
    if (failure) Fail(failure.message());
    Read();
    io_.restart();
    thread_ = std::thread([this] { io_.run(); });
  }
  // Says that it goes, so that the server need not wonder, and does not wait long for an answer.
  ~Connection() {
    constexpr Seconds kLongest(1);
    asio::steady_timer timer(io_);
    asio::post(io_, [this, &timer, kLongest] {
      timer.expires_after(std::chrono::duration_cast<std::chrono::nanoseconds>(kLongest));
      timer.async_wait([this](auto) { stream_.next_layer().close(); });
      stream_.async_close(beast::websocket::close_code::normal, [this, &timer](auto) {
        stream_.next_layer().close();
        timer.cancel();
      });
    });
    if (thread_.joinable()) thread_.join();
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void Send(const std::string& message) {
    const auto kept = std::make_shared<std::string>(message);
    asio::post(io_, [this, kept] {
      stream_.async_write(asio::buffer(*kept), [this, kept](auto failure, std::size_t) {
        if (failure) End(failure.message());
      });
    });
  }

  // What a server sends as soon as one connects.
  std::string ReceiveMetadata() { return Receive(patience_.answer, "sends no metadata"); }
  std::string ReceiveAnswer() {
    const double patience = answered_ ? patience_.answer : patience_.first_answer;
    answered_ = true;
    return Receive(patience, "does not answer");
  }

 private:
  std::string Receive(double patience, const char* failing) {
    std::unique_lock lock(mutex_);
    const bool came = changed_.wait_for(lock, Seconds(patience),
                                        [this] { return !messages_.empty() || !failure_.empty(); });
    if (!came) Fail(fmt::format("{} within {} s", failing, patience));
    if (messages_.empty()) Fail(failure_);
    const auto [message, is_text] = std::move(messages_.front());
    messages_.pop();
    if (is_text) Fail("says " + Quote(LastLine(message)));  // openpi's servers tell errors so
    return message;
  }

  // Tries again and again: a server that loads a model is not up at once.
  void Connect(const Address& address) {
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
      tcp::resolver resolver(io_);
      boost::system::error_code failure;
      const auto places = resolver.resolve(address.host, address.port, failure);
      if (!failure) {
        failure = Await([&](auto done) { stream_.next_layer().async_connect(places, done); });
      }
      if (!failure) return;
      const Seconds waited = std::chrono::steady_clock::now() - start;
      if (waited.count() >= patience_.wait) {
        Fail(fmt::format("{}, for {:.0f} s", failure.message(), waited.count()));
      }
      StopIfRequested();
      std::this_thread::sleep_for(std::min<Seconds>(Seconds(0.5), Seconds(patience_.wait)));
    }
  }

  // Waits for the end of an operation, before the thread runs.
  template <class Start>
  boost::system::error_code Await(const Start& start) {
    boost::system::error_code failure = beast::error::timeout;
    bool ended = false;
    start([&](boost::system::error_code error, const auto&...) {
      ended = true;
      failure = error;
    });
    io_.restart();
    io_.run_for(std::chrono::duration_cast<std::chrono::nanoseconds>(Seconds(patience_.answer)));
    if (!ended) {
      stream_.next_layer().close();
      io_.run();  // the operation's end, which refers to what is here
      failure = beast::error::timeout;
    }
    return failure;
  }

  // In the thread: one read after the other.
  void Read() {
    stream_.async_read(buffer_, [this](boost::system::error_code failure, std::size_t) {
      if (failure) {
        End(failure == beast::websocket::error::closed ? Closing() : failure.message());
        return;
      }
      {
        const std::lock_guard lock(mutex_);
        messages_.emplace(beast::buffers_to_string(buffer_.data()), stream_.got_text());
      }
      changed_.notify_all();
      buffer_.consume(buffer_.size());
      Read();
    });
  }
  // Why the server closed the connection, by its own words.
  std::string Closing() const {
    const beast::websocket::close_reason& reason = stream_.reason();
    if (reason.reason.empty()) return fmt::format("closed without a reason, code {}", reason.code);
    return fmt::format("closed: {}", Quote(reason.reason.c_str()));
  }
  void End(const std::string& failure) {
    {
      const std::lock_guard lock(mutex_);
      if (failure_.empty()) failure_ = failure;
    }
    changed_.notify_all();
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw PolicyServerError(fmt::format("policy server {}: {}", name_, what));
  }

  std::string name_;
  ServerPatience patience_;
  bool answered_ = false;
  asio::io_context io_;
  beast::websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::queue<std::pair<std::string, bool>> messages_;  // and whether it is text
  std::string failure_;
  std::thread thread_;  // of all operations after the handshake
};

class WebsocketPolicy : public Policy {
 public:
  WebsocketPolicy(const Task& task, PolicyAdapter adapter, const Address& address,
                  const ServerPatience& patience)
      : address_(address),
        patience_(patience),
        prompt_(task.prompt),
        robot_(task.robot),
        seconds_(adapter.frames_per_action / task.rate),
        adapter_(std::move(adapter)),
        chunks_(adapter_.chunks) {}

  bool NeedsImages() const override {
    return adapter_.NeedsImages() && held_ == 0 && chunks_.empty();
  }

  void Reset(std::uint64_t) override {
    held_ = 0;
    chunks_.Reset();
    command_.resize(0);
    connection_ = std::make_unique<Connection>(address_, patience_);
    CheckMetadata(connection_->ReceiveMetadata());
  }

  Eigen::VectorXd Act(const Observation& observation) override {
    if (command_.size() == 0) command_ = observation.robot;
    if (held_ == 0) {
      if (chunks_.empty()) {
        connection_->Send(EncodeObservation(adapter_, observation, prompt_));
        chunks_.Add(DecodeActions(connection_->ReceiveAnswer(), SizeOf(adapter_.action, robot_)));
      }
      command_ = ToAction(adapter_.action, chunks_.Next(),
                          {robot_, adapter_.frames, observation, command_, seconds_});
      held_ = adapter_.frames_per_action;
    }
    --held_;
    return command_;
  }

 private:
  Address address_;
  ServerPatience patience_;
  std::string prompt_;
  RobotOptions robot_;
  double seconds_;  // that an action lasts
  PolicyAdapter adapter_;
  ActionChunks chunks_;
  int held_ = 0;             // frames for which the last action still holds
  Eigen::VectorXd command_;  // the last action
  std::unique_ptr<Connection> connection_;
};

}  // namespace

std::unique_ptr<Policy> MakeWebsocketPolicy(const Task& task, const PolicyAdapter& adapter,
                                            const std::string& address,
                                            const ServerPatience& patience) {
  return std::make_unique<WebsocketPolicy>(task, adapter, ParseAddress(address), patience);
}

}  // namespace physpring
