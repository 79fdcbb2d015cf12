// SPDX-License-Identifier: GPL-2.0-only
//
// This file links to ns-3, which is under the GNU General Public License version 2; so is this file. The rest of
// Sendworthy reaches it through the C functions below only.
//
// A Wi-Fi channel with robots on it, as plain functions: send a datagram, go on until one arrives. ns-3 has one
// simulator a process, so there is one channel at a time. Times are seconds since the channel was ready.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ns3/error-model.h"
#include "ns3/inet-socket-address.h"
#include "ns3/internet-stack-helper.h"
#include "ns3/ipv4-address-generator.h"
#include "ns3/ipv4-address-helper.h"
#include "ns3/mac48-address.h"
#include "ns3/mobility-helper.h"
#include "ns3/neighbor-cache-helper.h"
#include "ns3/node-container.h"
#include "ns3/packet.h"
#include "ns3/propagation-delay-model.h"
#include "ns3/propagation-loss-model.h"
#include "ns3/rng-seed-manager.h"
#include "ns3/simulator.h"
#include "ns3/socket.h"
#include "ns3/ssid.h"
#include "ns3/string.h"
#include "ns3/udp-socket-factory.h"
#include "ns3/wifi-mac-helper.h"
#include "ns3/wifi-net-device.h"
#include "ns3/wifi-phy.h"
#include "ns3/yans-wifi-channel.h"
#include "ns3/yans-wifi-helper.h"

namespace {

using ns3::Create;
using ns3::CreateObject;
using ns3::Ptr;
using ns3::Seconds;
using ns3::Simulator;
using ns3::StringValue;

constexpr std::uint16_t kPort = 7447;
constexpr std::uint32_t kLargest = 60'000;  // of a datagram [B]; larger messages take several
constexpr std::size_t kIncomplete = 4'096;  // messages of which parts are missing are remembered, the newest ones
constexpr double kAssociation = 3.0;        // until all stations have found the access point [s]
constexpr std::int64_t kStreams = 1'000;    // of random numbers, from this one on

struct Arrival {
    std::uint64_t id;
    std::int32_t receiver;
    double at;
};

struct Head {
    std::uint64_t id;
    std::uint32_t parts;
};

struct Channel {
    ns3::NodeContainer nodes;
    std::vector<Ptr<ns3::Socket>> sockets;
    std::vector<ns3::Ipv4Address> addresses;
    std::deque<Arrival> arrived;
    std::map<std::pair<std::uint64_t, std::int32_t>, std::uint32_t> incomplete;
    double ready = 0.0;

    double now() const { return Simulator::Now().GetSeconds() - ready; }
    ns3::Time until(double at) const { return ns3::Max(Seconds(at + ready) - Simulator::Now(), Seconds(0)); }
};

std::unique_ptr<Channel> channel;

void take(std::int32_t receiver, const Ptr<ns3::Socket>& socket) {
    while (const Ptr<ns3::Packet> packet = socket->Recv()) {
        Head head{};
        packet->CopyData(reinterpret_cast<std::uint8_t*>(&head), sizeof head);
        if (head.parts > 1) {
            const auto place = std::make_pair(head.id, receiver);
            if (++channel->incomplete[place] < head.parts) {
                if (channel->incomplete.size() > kIncomplete) channel->incomplete.erase(channel->incomplete.begin());
                continue;
            }
            channel->incomplete.erase(place);
        }
        channel->arrived.push_back({head.id, receiver, channel->now()});
        Simulator::Stop();
    }
}

void send_datagrams(int sender, int receiver, std::uint32_t size, std::uint64_t id) {
    const Head head{id, std::max(1U, (size + kLargest - 1) / kLargest)};
    const auto to = receiver < 0 ? ns3::Ipv4Address("10.1.255.255") : channel->addresses.at(receiver);
    for (std::uint32_t part = 0; part < head.parts; part++) {
        const auto length = std::min(kLargest, size - part * kLargest);
        std::vector<std::uint8_t> bytes(std::max<std::size_t>(length, sizeof head));
        std::memcpy(bytes.data(), &head, sizeof head);
        channel->sockets.at(sender)->SendTo(Create<ns3::Packet>(bytes.data(), bytes.size()), 0,
                                                                                ns3::InetSocketAddress(to, kPort));
    }
}

ns3::YansWifiPhyHelper air(double strength) {
    auto loss = CreateObject<ns3::FixedRssLossModel>();
    loss->SetRss(strength);
    auto medium = CreateObject<ns3::YansWifiChannel>();
    medium->SetPropagationDelayModel(CreateObject<ns3::ConstantSpeedPropagationDelayModel>());
    medium->SetPropagationLossModel(loss);
    ns3::YansWifiPhyHelper phy;
    phy.SetChannel(medium);
    return phy;
}

ns3::NetDeviceContainer devices(const ns3::YansWifiPhyHelper& phy, const char* standard, const char* rate, int robots) {
    ns3::WifiHelper wifi;
    wifi.SetStandard(std::string(standard) == "802.11b" ? ns3::WIFI_STANDARD_80211b : ns3::WIFI_STANDARD_80211g);
    wifi.SetRemoteStationManager("ns3::ConstantRateWifiManager", "DataMode", StringValue(rate), "ControlMode",
                               StringValue(rate), "NonUnicastMode", StringValue(rate));
    ns3::WifiMacHelper mac;
    if (channel->nodes.GetN() == static_cast<std::uint32_t>(robots)) {
        mac.SetType("ns3::AdhocWifiMac");
        return wifi.Install(phy, mac, channel->nodes);
    }
    const auto ssid = ns3::SsidValue(ns3::Ssid("team"));
    ns3::NodeContainer stations;
    for (int robot = 0; robot < robots; robot++) stations.Add(channel->nodes.Get(robot));
    mac.SetType("ns3::StaWifiMac", "Ssid", ssid);
    auto installed = wifi.Install(phy, mac, stations);
    mac.SetType("ns3::ApWifiMac", "Ssid", ssid);
    installed.Add(wifi.Install(phy, mac, ns3::NodeContainer(channel->nodes.Get(robots))));
    return installed;
}

void lose(const ns3::NetDeviceContainer& installed, double part) {
    for (std::uint32_t i = 0; i < installed.GetN(); i++) {
        auto errors = CreateObject<ns3::RateErrorModel>();
        errors->SetUnit(ns3::RateErrorModel::ERROR_UNIT_PACKET);
        errors->SetRate(part);
        errors->AssignStreams(kStreams / 2 + i);
        ns3::DynamicCast<ns3::WifiNetDevice>(installed.Get(i))->GetPhy()->SetPostReceptionErrorModel(errors);
    }
}

void connect(const ns3::NetDeviceContainer& installed, int robots) {
    ns3::InternetStackHelper internet;
    internet.Install(channel->nodes);
    ns3::Ipv4AddressHelper network("10.1.0.0", "255.255.0.0");
    const auto interfaces = network.Assign(installed);
    for (int robot = 0; robot < robots; robot++) {
        channel->addresses.push_back(interfaces.GetAddress(robot));
        auto socket = ns3::Socket::CreateSocket(channel->nodes.Get(robot), ns3::UdpSocketFactory::GetTypeId());
        socket->SetAllowBroadcast(true);
        socket->Bind(ns3::InetSocketAddress(ns3::Ipv4Address::GetAny(), kPort));
        socket->SetRecvCallback([robot](Ptr<ns3::Socket> readable) { take(robot, readable); });
        channel->sockets.push_back(socket);
    }
}

}  // namespace

extern "C" {

// Forgets the channel and all that is on it.
void radio_close() {
    channel.reset();
    Simulator::Destroy();
    // These count on otherwise, and the same seed would fly otherwise after another channel.
    ns3::RngSeedManager::ResetNextStreamIndex();
    ns3::Mac48Address::ResetAllocationIndex();
    ns3::Ipv4AddressGenerator::Reset();
}

// Makes a channel for so many robots: ad hoc, or with an access point. `strength` is that of every signal where it is
// received [dBm]; `loss` is the part of frames that are not received all the same.
void radio_open(int robots, const char* standard, const char* rate, double strength, double loss, int access_point,
                                std::uint32_t seed) {
    radio_close();
    ns3::RngSeedManager::SetRun(seed);
    channel = std::make_unique<Channel>();
    channel->nodes.Create(robots + (access_point != 0 ? 1 : 0));
    ns3::MobilityHelper mobility;
    mobility.SetMobilityModel("ns3::ConstantPositionMobilityModel");
    mobility.Install(channel->nodes);
    const auto installed = devices(air(strength), standard, rate, robots);
    ns3::WifiHelper::AssignStreams(installed, kStreams);
    connect(installed, robots);
    if (access_point != 0) {
        Simulator::Stop(Seconds(kAssociation));
        Simulator::Run();
    }
    // Who associates forgets whom it knew, and one question for an address that is lost would make a robot unreachable for
    // minutes, as none is here: robots have met before.
    ns3::NeighborCacheHelper().PopulateNeighborCache();
    if (loss > 0.0) lose(installed, loss);
    channel->ready = Simulator::Now().GetSeconds();
}

// Has a robot send `size` bytes at `at` [s], or now if that is over: to a robot, or to all (-1). `id` names them.
void radio_send(double at, int sender, int receiver, std::uint32_t size, std::uint64_t id) {
    Simulator::Schedule(channel->until(at), [=] { send_datagrams(sender, receiver, size, id); });
}

// Goes on until `until` [s], or until something arrives. Writes what arrived, at most `most`; returns how many that are.
int radio_run(double until, Arrival* arrivals, int most) {
    if (channel->arrived.empty()) {
        auto end = Simulator::Schedule(channel->until(until), [] { Simulator::Stop(); });
        Simulator::Run();
        end.Cancel();
    }
    int count = 0;
    for (; count < most && !channel->arrived.empty(); count++) {
        arrivals[count] = channel->arrived.front();
        channel->arrived.pop_front();
    }
    return count;
}

}  // extern "C"
