#include "energy/element_blocks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <set>
#include <thread>

#include "base/lanes.hpp"
#include "support/meshes.hpp"

using namespace almesh;
using namespace almesh::test;

namespace {

std::set<int> nodes_of(const Mesh& mesh, const ElementBlocks& blocks, int block) {
    std::set<int> nodes;
    const int end = std::min(mesh.element_count(), (block + 1) * blocks.size);
    for (int k = block * blocks.size; k < end; ++k)
        nodes.insert(mesh.element(blocks.order[k]), mesh.element(blocks.order[k]) + mesh.element_nodes());
    return nodes;
}

bool share_node(const std::set<int>& a, const std::set<int>& b) {
    return std::any_of(a.begin(), a.end(), [&](int node) { return b.count(node) > 0; });
}

std::vector<int> waits_of(const ElementBlocks& blocks, int slot) {
    return {blocks.wait_for.begin() + blocks.wait_start[slot], blocks.wait_for.begin() + blocks.wait_start[slot + 1]};
}

// Part of the slots that wait for one of the three slots before them.
double close_waits(const ElementBlocks& blocks) {
    int close = 0;
    for (int t = 0; t < blocks.count(); ++t) {
        const std::vector<int> waits = waits_of(blocks, t);
        close += std::any_of(waits.begin(), waits.end(), [t](int earlier) { return t - earlier <= 3; });
    }
    return static_cast<double>(close) / blocks.count();
}

}  // namespace

TEST_CASE("blocks hold every element once, and have one slot each") {
    for (const Mesh& mesh : {square_mesh(1), square_mesh(40), cube_mesh(6), raise_degree(ring_mesh(20, 5, 9), 3)}) {
        ElementBlocks blocks = schedule_elements(mesh);
        CHECK(blocks.size % lanes == 0);
        CHECK(blocks.count() == (mesh.element_count() + blocks.size - 1) / blocks.size);
        CHECK(std::set<int>(blocks.order.begin(), blocks.order.end()).size() ==
              static_cast<std::size_t>(mesh.element_count()));
        std::vector<int> slots = blocks.schedule;
        std::sort(slots.begin(), slots.end());
        for (int c = 0; c < blocks.count(); ++c) CHECK(slots[c] == c);
    }
}

TEST_CASE("a block waits for exactly the earlier ones that share a node with it") {
    for (const Mesh& mesh : {square_mesh(1), square_mesh(15), cube_mesh(4), raise_degree(ring_mesh(20, 5, 9), 3)}) {
        ElementBlocks blocks = schedule_elements(mesh);
        std::vector<std::set<int>> nodes;
        for (int t = 0; t < blocks.count(); ++t) {
            nodes.push_back(nodes_of(mesh, blocks, blocks.schedule[t]));
            std::vector<int> expected, waits = waits_of(blocks, t);
            for (int earlier = 0; earlier < t; ++earlier)
                if (share_node(nodes[earlier], nodes[t])) expected.push_back(earlier);
            std::sort(waits.begin(), waits.end());
            CHECK(waits == expected);
        }
        CHECK(blocks.wait_start.size() == static_cast<std::size_t>(blocks.count()) + 1);
        CHECK(blocks.wait_start.back() == static_cast<int>(blocks.wait_for.size()));
    }
}

TEST_CASE("every node sees its blocks in the order of their slots, for any number of threads and every time") {
    const Mesh mesh = cube_mesh(8);
    ElementBlocks blocks = schedule_elements(mesh);
    std::vector<std::vector<int>> expected(mesh.nodes());
    for (int block : blocks.schedule)
        for (int node : nodes_of(mesh, blocks, block)) expected[node].push_back(block);
    const int before = max_threads();
    for (int threads : {1, 2, 3, 8, 2}) {
        set_threads(threads);
        std::vector<std::vector<int>> seen(mesh.nodes());
        blocks.in_schedule(true, [&](int block) {
            for (int node : nodes_of(mesh, blocks, block)) seen[node].push_back(block);
        });
        CHECK(seen == expected);
    }
    set_threads(before);
}

TEST_CASE("a slot waits however long the earlier one takes, every time") {
    ElementBlocks chain;
    const int count = 40;
    chain.wait_start = {0};
    for (int t = 0; t < count; ++t) {
        chain.schedule.push_back(t);
        if (t > 0) chain.wait_for.push_back(t - 1);
        chain.wait_start.push_back(static_cast<int>(chain.wait_for.size()));
    }
    ElementBlocks copy = chain, *const again[] = {&chain, &chain, &copy, &chain};
    const int before = max_threads();
    set_threads(2);
    for (ElementBlocks* blocks : again) {
        std::atomic<int> next = 0;
        bool in_order = true;
        blocks->in_schedule(true, [&](int block) {
            if (block % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            in_order = in_order && next++ == block;
        });
        CHECK(in_order);
        CHECK(next == count);
    }
    set_threads(before);
}

TEST_CASE("a mesh of some size has blocks for many threads, which seldom wait") {
    for (const Mesh& mesh : {square_mesh(40), cube_mesh(10), raise_degree(ring_mesh(40, 10, 9), 4)}) {
        ElementBlocks blocks = schedule_elements(mesh);
        CHECK(blocks.count() >= 90);
        CHECK(close_waits(blocks) < 0.1);
    }
}

TEST_CASE("elements in an order without rhyme are put into one where blocks have few neighbours") {
    for (Mesh mesh : {square_mesh(40), cube_mesh(10)}) {
        const std::vector<int> ordered = mesh.elements;
        const int m = mesh.element_nodes(), count = mesh.element_count();
        for (int e = 0; e < count; ++e)  // 1009 and the number of elements have no common divisor
            std::copy_n(&ordered[static_cast<long long>(e) * 1009 % count * m], m, &mesh.elements[e * m]);
        ElementBlocks blocks = schedule_elements(mesh);
        CHECK(blocks.count() >= 100);
        CHECK(blocks.wait_for.size() <= static_cast<std::size_t>(blocks.count() * (mesh.dim == 2 ? 5 : 15)));
        CHECK(close_waits(blocks) < 0.1);
        CHECK(std::set<int>(blocks.order.begin(), blocks.order.end()).size() == static_cast<std::size_t>(count));
    }
}
