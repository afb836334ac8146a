// SPDX-License-Identifier: Apache-2.0
// dds_publish_forever PARTITION: waits for a subscriber, publishes one frame, then stays for two
// minutes, unless it is killed before.

#include <unistd.h>

#include <condition_variable>
#include <mutex>

#include "service/dds/publisher.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::mutex mutex;
  std::condition_variable changed;
  int subscribers = 0;
  windhover::PublishOptions options;
  options.partition = argv[1];
  windhover::Publisher publisher(options, [&](int now) {
    const std::lock_guard lock(mutex);
    subscribers = now;
    changed.notify_all();
  });
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return subscribers > 0; });
  }
  publisher.Publish(windhover::FrameRegistration(), 8, 8, 0);
  publisher.Publish(0, 8, 8, 0, {});
  alarm(120);
  pause();
  return 0;
}
