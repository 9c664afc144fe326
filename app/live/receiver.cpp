#include "app/live/receiver.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <limits>

#include "geometry/error.h"

namespace fascia::app {

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int bound_socket(uint16_t port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) throw Error(std::string("no UDP socket: ") + std::strerror(errno));
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return descriptor;
  const std::string reason = std::strerror(errno);
  close(descriptor);
  throw Error("UDP port " + std::to_string(port) + " cannot be had (" + reason +
              "): end the program that holds it, or choose another port");
}

}  // namespace

LiveReceiver::LiveReceiver(Protocol protocol, uint16_t port) : protocol_(protocol) {
  socket_ = bound_socket(port);
  sockaddr_in address = {};
  socklen_t size = sizeof address;
  if (getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0)
    port_ = ntohs(address.sin_port);
  if (pipe2(wake_, O_CLOEXEC) != 0) {
    close(socket_);
    throw Error(std::string("no pipe: ") + std::strerror(errno));
  }
  thread_ = std::thread([this] { run(); });
}

LiveReceiver::~LiveReceiver() {
  const char end = 0;
  // The pipe is empty and open: one byte always fits.
  [[maybe_unused]] const ssize_t written = write(wake_[1], &end, 1);
  thread_.join();
  for (const int descriptor : {socket_, wake_[0], wake_[1]})
    close(descriptor);
}

CapturedValues LiveReceiver::values() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return values_;
}

double LiveReceiver::seconds_since_last() const {
  const double last = last_;
  return last < 0.0 ? std::numeric_limits<double>::infinity() : now() - last;
}

void LiveReceiver::run() {
  std::array<uint8_t, 65536> bytes;
  for (;;) {
    std::array<pollfd, 2> waits = {{{socket_, POLLIN, 0}, {wake_[0], POLLIN, 0}}};
    if (poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR) return;
    if (waits[1].revents) return;
    const ssize_t count = recv(socket_, bytes.data(), bytes.size(), 0);
    if (count <= 0) continue;
    const std::span<const uint8_t> datagram(bytes.data(), static_cast<size_t>(count));
    const size_t most_names = 1024;  // whatever is sent, memory stays bounded
    const std::lock_guard<std::mutex> lock(mutex_);
    if (values_.size() > most_names) values_.clear();
    const bool is_understood =
        protocol_ == Protocol::osc ? read_osc(datagram, values_) : read_live_link(datagram, values_);
    ++(is_understood ? datagrams_ : refused_);
    if (is_understood) last_ = now();
  }
}

}  // namespace fascia::app
