// The register map, version 1: where what lies, and the image that clients read (docs/gateway.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace packcell_programs {

constexpr uint16_t kMapMagic = 0x504B;  // "PK"
constexpr uint16_t kMapMajor = 1;
// 1: pages of a result (100, 101), the next job order (229..231); 2: scenario and bin (1008..1013).
constexpr uint16_t kMapMinor = 2;

constexpr int kArms = 2;
constexpr const char *arm_name(int arm) { return arm == 0 ? "A" : "B"; }

// Command blocks, one an arm.
constexpr uint16_t kCommandA = 0;
constexpr uint16_t kCommandB = 48;
constexpr uint16_t kCommandSize = 48;
constexpr uint16_t kSeqHead = 0;
constexpr uint16_t kCode = 1;
constexpr uint16_t kFlags = 2;
constexpr uint16_t kPayload = 3;
constexpr uint16_t kSeqTail = 47;
constexpr uint16_t command_block(int arm) { return arm == 0 ? kCommandA : kCommandB; }

// The link: what goes past the commands.
constexpr uint16_t kLink = 96;
constexpr uint16_t kLinkSize = 8;
constexpr uint16_t kPlcHeartbeat = 96;
constexpr uint16_t kCancelSeq = 97;
constexpr uint16_t kControlCommand = 98;
constexpr uint16_t kChangeRequest = 99;
constexpr uint16_t kPageA = 100;  // page of result A that is shown, from 0
constexpr uint16_t kPageB = 101;

// Status.
constexpr uint16_t kStatus = 200;
constexpr uint16_t kStatusSize = 32;
constexpr uint16_t kMagic = 200;
constexpr uint16_t kMajor = 201;
constexpr uint16_t kMinor = 202;
constexpr uint16_t kBootId = 203;
constexpr uint16_t kGatewayHeartbeat = 204;
constexpr uint16_t kStateCurrent = 205;
constexpr uint16_t kUnitModeCurrent = 206;
constexpr uint16_t kAckSeqA = 207;  // then done_seq, result and reject_code; arm B's from 211
constexpr uint16_t kArmStatusSize = 4;
constexpr uint16_t kQueueDepth = 215;
constexpr uint16_t kPlcHeartbeatAge = 216;
constexpr uint16_t kLastPlanMs = 217;
constexpr uint16_t kJournalSequence = 218;  // 32 bits
constexpr uint16_t kUtilization = 220;      // 0.01 %
constexpr uint16_t kItemsInBin = 221;
constexpr uint16_t kItemsOnBelt = 222;
constexpr uint16_t kBufferedItems = 223;
constexpr uint16_t kBinsClosed = 224;  // 32 bits
constexpr uint16_t kKAlpha = 226;
constexpr uint16_t kKShared = 227;
constexpr uint16_t kKBeta = 228;
constexpr uint16_t kNextJob = 229;  // 32 bits, 0: none
constexpr uint16_t kJobsWaiting = 231;

// Result blocks.
constexpr uint16_t kResultA = 300;
constexpr uint16_t kResultB = 400;
constexpr uint16_t kResultSize = 64;
constexpr uint16_t kActionCount = 1;
constexpr uint16_t kPageIndex = 2;
constexpr uint16_t kPages = 3;
constexpr uint16_t kActions = 4;
constexpr uint16_t kActionSize = 8;
constexpr uint16_t kActionsPerPage = 7;
constexpr uint16_t kResultTail = 63;

// Identity.
constexpr uint16_t kIdentity = 1000;
constexpr uint16_t kIdentitySize = 16;
constexpr uint16_t kIdentityScenario = 1008;  // robots, recognised, accessible, overlap
constexpr uint16_t kIdentityBin = 1012;

constexpr uint16_t kRegisters = kIdentity + kIdentitySize;
using Registers = std::array<uint16_t, kRegisters>;

// Whether all of `count` registers from `address` on may be read, or written.
bool is_readable(unsigned address, unsigned count);
bool is_writable(unsigned address, unsigned count);

// Which of the two words of a 32-bit value comes first.
enum class WordOrder { kHighFirst, kLowFirst };  // ABCD, CDAB

uint32_t join_words(WordOrder order, uint16_t first, uint16_t second);
void put_words(WordOrder order, uint32_t value, uint16_t *two);

}  // namespace packcell_programs
