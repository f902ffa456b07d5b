// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/channel.hpp"

#include "common/base/error.hpp"
#include "common/coupling/serve.hpp"
#include "common/coupling/wait.hpp"

namespace couplet {

void MpiChannel::send(const Command& command) {
  pending_ = command.op;
  send_bytes(peers_, 0, command_tag, pack(command),
             fmt::format("'{}' to take {}", name_, couplet::name(pending_)));
}

Reply MpiChannel::receive() {
  return unpack_reply(
      receive_bytes(peers_, 0, reply_tag, fmt::format("'{}' to answer {}", name_, couplet::name(pending_))));
}

void LocalChannel::send(const Command& command) { reply_ = carry_out(command, participant_, name_, comm_); }

}  // namespace couplet
