#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "app/live/packets.h"

namespace fascia::app {

/// Listens on the loopback interface for captured faces, on a thread of its own.
class LiveReceiver {
 public:
  enum class Protocol { osc, live_link };

  /// Throws fascia::Error when the port cannot be had. Port 0: any free one.
  LiveReceiver(Protocol protocol, uint16_t port);
  ~LiveReceiver();
  LiveReceiver(const LiveReceiver&) = delete;
  LiveReceiver& operator=(const LiveReceiver&) = delete;

  CapturedValues values() const;
  uint64_t datagrams() const { return datagrams_; }  ///< understood
  uint64_t refused() const { return refused_; }      ///< not understood
  double seconds_since_last() const;                 ///< infinity before the first
  uint16_t port() const { return port_; }
  Protocol protocol() const { return protocol_; }

 private:
  void run();

  Protocol protocol_;
  uint16_t port_ = 0;
  int socket_ = -1;
  int wake_[2] = {-1, -1};  ///< a pipe that ends the wait
  mutable std::mutex mutex_;
  CapturedValues values_;
  std::atomic<uint64_t> datagrams_ = 0, refused_ = 0;
  std::atomic<double> last_ = -1.0;
  std::thread thread_;
};

constexpr uint16_t vmc_port = 39539;        ///< the VMC protocol's, for performers
constexpr uint16_t live_link_port = 11111;  ///< Live Link Face's

}  // namespace fascia::app
