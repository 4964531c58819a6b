// SPDX-License-Identifier: Apache-2.0
// What a policy server may say, and what is refused before anything is made of it. Messages are
// written by hand, byte by byte, from the specification of msgpack.
#include "rollout/policies/openpi_messages.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

std::string Bytes(const std::string& text) {  // bin 8
  return "\xc4" + std::string(1, static_cast<char>(text.size())) + text;
}

// {b"actions": {b"__ndarray__": true, b"data": ..., b"dtype": ..., b"shape": [...]}}
std::string Answer(const std::string& data, const std::string& type, const std::string& shape) {
  return "\x81" + Bytes("actions") + "\x84" + Bytes("__ndarray__") + "\xc3" + Bytes("data") +
         Bytes(data) + Bytes("dtype") + Bytes(type) + Bytes("shape") + shape;
}

const std::string kOneAndTwo("\0\0\x80\x3f\0\0\0\x40", 8);  // <f4

std::string Refusal(const std::string& message) {
  try {
    DecodeActions(message, 2);
  } catch (const PolicyError& error) {
    return error.what();
  } catch (const PolicyServerError& error) {
    return error.what();
  }
  return "";
}

TEST(OpenpiMessages, ActionsAreNumbersByFrames) {
  EXPECT_EQ(DecodeActions(Answer(kOneAndTwo, "<f4", "\x92\x01\x02"), 2),
            Eigen::MatrixXd(Eigen::Vector2d(1, 2)));
  EXPECT_EQ(DecodeActions(Answer(kOneAndTwo, "<f4", "\x92\x02\x01"), 1),
            Eigen::MatrixXd(Eigen::RowVector2d(1, 2)));
}

TEST(OpenpiMessages, OtherShapesAndTypesAreRefused) {
  EXPECT_EQ(Refusal(Answer(kOneAndTwo, "<f4", "\x92\x02\x01")),
            "the policy server's actions have shape (2, 1), expected (n, 2)");
  EXPECT_EQ(Refusal(Answer(kOneAndTwo, "<f4", "\x92\xcf\x80" + std::string(7, '\0') + "\x02")),
            "the policy server's actions have shape (9223372036854775808, 2), expected (n, 2)");
  EXPECT_EQ(Refusal(Answer(kOneAndTwo, "<f4", "\x95\x01\x01\x01\x01\x02")),
            "the policy server's actions have shape (), expected (n, 2)");
  EXPECT_EQ(Refusal(Answer(kOneAndTwo, "<f2", "\x92\x01\x02")),
            "the policy server's actions are of type '<f2', expected <f4 or <f8");
}

// Who sends no actions at all speaks another protocol, which says nothing of the policy.
TEST(OpenpiMessages, OtherActionsAreThePolicysFaultAndOtherMessagesTheServers) {
  EXPECT_THROW(DecodeActions(Answer(kOneAndTwo, "<f4", "\x92\x02\x01"), 2), PolicyError);
  for (const std::string& message :
       {std::string("\xc1"), std::string("\x80"), Answer(kOneAndTwo, "<f2", "\x92\x01\x02"),
        std::string("\x81") + Bytes("actions") + "\x92\x01\x02"}) {
    EXPECT_THROW(DecodeActions(message, 2), PolicyServerError);
  }
  EXPECT_THROW(CheckMetadata("\x92\x01\x02"), PolicyServerError);
}

TEST(OpenpiMessages, WhatIsCutShortIsRefused) {
  const std::string whole = Answer(kOneAndTwo, "<f4", "\x92\x01\x02");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_EQ(Refusal(whole.substr(0, length)), "the policy server's message is not msgpack");
  }
  EXPECT_EQ(Refusal("\xc1"), "the policy server's message is not msgpack");  // never used
}

// An item takes 24 bytes of memory, and 1 of the message: counted before any is made.
TEST(OpenpiMessages, ItemsAreCounted) {
  const std::string too_many = "the policy server's message has too many items";
  const std::string nils = std::string("\xdd\0\xff\xff\xff", 5) + std::string(0xffffff, '\xc0');
  EXPECT_EQ(Refusal(nils), too_many);
  EXPECT_EQ(Refusal("\xdd\xff\xff\xff\xff\xc0"), too_many);  // announced only
  EXPECT_EQ(Refusal("\xdf\xff\xff\xff\xff\xc0"), too_many);  // a map
  std::string arrays = "\x94";
  for (int i = 0; i < 4; ++i) {
    arrays += std::string("\xdd\0\0\x7f\xff", 5) + std::string(0x7fff, '\xc0');
  }
  EXPECT_EQ(Refusal(arrays), too_many);  // together
  EXPECT_EQ(Refusal(std::string("\xdd\0\0\xff\xff", 5) + std::string(0xffff, '\xc0')),
            "the policy server's answer has no actions");
}

TEST(OpenpiMessages, DepthIsLimited) {
  const std::string deep = "the policy server's message has too many items";
  EXPECT_EQ(Refusal(std::string(1000000, '\x91') + '\xc0'), deep);
  EXPECT_EQ(Refusal(std::string(17, '\x91') + '\xc0'), deep);
  EXPECT_EQ(Refusal(std::string(16, '\x91') + '\xc0'), "the policy server's answer has no actions");
  std::string beside = "\x9f";  // one beside the other is not deep
  for (int i = 0; i < 15; ++i) beside += i % 2 == 0 ? "\x90" : "\x81\x90\x80";
  EXPECT_EQ(Refusal(beside + beside), "the policy server's answer has no actions");
}

TEST(OpenpiMessages, MetadataIsAMap) {
  EXPECT_NO_THROW(CheckMetadata("\x80"));
  EXPECT_THROW(CheckMetadata("\x90"), PolicyServerError);
  EXPECT_THROW(CheckMetadata(std::string(1000000, '\x81')), PolicyServerError);
}

}  // namespace
}  // namespace physpring
