#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <random>
#include <thread>

#include "app/live/packets.h"
#include "app/live/receiver.h"
#include "geometry/error.h"

namespace fascia::app {
namespace {

using Bytes = std::vector<uint8_t>;

void put(Bytes& bytes, uint32_t number) {
  for (const int shift : {24, 16, 8, 0})
    bytes.push_back(static_cast<uint8_t>(number >> shift));
}
void put(Bytes& bytes, float number) {
  put(bytes, std::bit_cast<uint32_t>(number));
}
void put_text(Bytes& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  for (size_t i = 0; i < 4 - text.size() % 4; ++i)
    bytes.push_back(0);
}

Bytes vmc(const std::string& name, float value) {
  Bytes bytes;
  put_text(bytes, "/VMC/Ext/Blend/Val");
  put_text(bytes, ",sf");
  put_text(bytes, name);
  put(bytes, value);
  return bytes;
}

Bytes bundle(const std::vector<Bytes>& messages) {
  Bytes bytes;
  put_text(bytes, "#bundle");
  put(bytes, uint32_t{0});
  put(bytes, uint32_t{1});
  for (const Bytes& message : messages) {
    put(bytes, static_cast<uint32_t>(message.size()));
    bytes.insert(bytes.end(), message.begin(), message.end());
  }
  return bytes;
}

Bytes live_link(const std::string& subject) {
  Bytes bytes(41, '$');
  bytes[0] = 6;
  bytes[1] = bytes[2] = bytes[3] = 0;
  put(bytes, static_cast<uint32_t>(subject.size()));
  bytes.insert(bytes.end(), subject.begin(), subject.end());
  bytes.insert(bytes.end(), 16, 0);
  bytes.push_back(61);
  for (int i = 0; i < 61; ++i)
    put(bytes, 0.01F * static_cast<float>(i));
  return bytes;
}

TEST(Osc, ReadsVmcPlainMessagesAndBundlesInBundles) {
  CapturedValues values;
  EXPECT_TRUE(read_osc(bundle({vmc("Joy", 0.5F), bundle({vmc("jawOpen", 0.25F)})}), values));
  Bytes plain;
  put_text(plain, "/face/mouthSmileLeft");
  put_text(plain, ",f");
  put(plain, 0.75F);
  EXPECT_TRUE(read_osc(plain, values));
  EXPECT_EQ(values, (CapturedValues{{"Joy", 0.5}, {"jawOpen", 0.25}, {"mouthSmileLeft", 0.75}}));
}

TEST(Osc, LeavesOutBonesAndWhatIsNotFinite) {
  CapturedValues values;
  Bytes bone;
  put_text(bone, "/VMC/Ext/Bone/Pos");
  put_text(bone, ",sf");
  put_text(bone, "Head");
  put(bone, 1.0F);
  EXPECT_FALSE(read_osc(bone, values));
  EXPECT_FALSE(read_osc(vmc("Joy", std::numeric_limits<float>::infinity()), values));
  EXPECT_TRUE(values.empty());
}

TEST(LiveLink, ReadsArkitsNamesInTheirOrder) {
  CapturedValues values;
  EXPECT_TRUE(read_live_link(live_link("iPhone of Anna"), values));
  EXPECT_EQ(values.size(), 52U);
  EXPECT_NEAR(values.at("arkit:eyeBlinkLeft"), 0.0, 1e-6);
  EXPECT_NEAR(values.at("arkit:jawOpen"), 0.17, 1e-6);
  EXPECT_NEAR(values.at("arkit:tongueOut"), 0.51, 1e-6);
}

TEST(Packets, ArbitraryBytesAreHandled) {
  std::mt19937 random(5);
  const std::vector<Bytes> good = {bundle({vmc("Joy", 0.5F), bundle({vmc("A", 1.0F)})}), live_link("x")};
  for (const Bytes& whole : good)
    for (size_t length = 0; length <= whole.size(); ++length) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      CapturedValues values;
      read_osc(cut, values);
      EXPECT_EQ(read_live_link(cut, values), &whole == &good[1] && length == whole.size());
    }
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes = good[static_cast<size_t>(round % 2)];
    for (int i = 0; i < 4; ++i)
      bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    CapturedValues values;
    read_osc(bytes, values);
    read_live_link(bytes, values);
    for (const auto& [name, value] : values)
      ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(Receiver, HearsWhatIsSentToItsPort) {
  LiveReceiver receiver(LiveReceiver::Protocol::osc, 0);
  ASSERT_GT(receiver.port(), 0);
  EXPECT_THROW(LiveReceiver(LiveReceiver::Protocol::osc, receiver.port()), Error);
  const int sender = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(receiver.port());
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto send = [&](const Bytes& bytes) {
    sendto(sender, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address),
           sizeof address);
  };
  send({1, 2, 3});
  send(vmc("jawOpen", 0.5F));
  for (int i = 0; i < 500 && receiver.datagrams() + receiver.refused() < 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  close(sender);
  EXPECT_EQ(receiver.datagrams(), 1U);
  EXPECT_EQ(receiver.refused(), 1U);
  EXPECT_EQ(receiver.values(), (CapturedValues{{"jawOpen", 0.5}}));
}

}  // namespace
}  // namespace fascia::app
