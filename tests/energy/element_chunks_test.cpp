#include "energy/element_chunks.hpp"

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

std::set<int> nodes_of(const Mesh& mesh, const ElementChunks& chunks, int chunk) {
    std::set<int> nodes;
    const int end = std::min(mesh.element_count(), (chunk + 1) * chunks.size);
    for (int k = chunk * chunks.size; k < end; ++k)
        nodes.insert(mesh.element(chunks.order[k]), mesh.element(chunks.order[k]) + mesh.element_nodes());
    return nodes;
}

bool share_node(const std::set<int>& a, const std::set<int>& b) {
    return std::any_of(a.begin(), a.end(), [&](int node) { return b.count(node) > 0; });
}

std::vector<int> waits_of(const ElementChunks& chunks, int turn) {
    return {chunks.wait_for.begin() + chunks.wait_start[turn], chunks.wait_for.begin() + chunks.wait_start[turn + 1]};
}

// Part of the turns that wait for one of the three turns before them.
double close_waits(const ElementChunks& chunks) {
    int close = 0;
    for (int t = 0; t < chunks.count(); ++t) {
        const std::vector<int> waits = waits_of(chunks, t);
        close += std::any_of(waits.begin(), waits.end(), [t](int earlier) { return t - earlier <= 3; });
    }
    return static_cast<double>(close) / chunks.count();
}

}  // namespace

TEST_CASE("chunks hold every element once, and have one turn each") {
    for (const Mesh& mesh : {square_mesh(1), square_mesh(40), cube_mesh(6), raise_degree(ring_mesh(20, 5, 9), 3)}) {
        const ElementChunks chunks = chunk_elements(mesh);
        CHECK(chunks.size % lanes == 0);
        CHECK(chunks.count() == (mesh.element_count() + chunks.size - 1) / chunks.size);
        CHECK(std::set<int>(chunks.order.begin(), chunks.order.end()).size() ==
              static_cast<std::size_t>(mesh.element_count()));
        std::vector<int> turns = chunks.turn;
        std::sort(turns.begin(), turns.end());
        for (int c = 0; c < chunks.count(); ++c) CHECK(turns[c] == c);
    }
}

TEST_CASE("a chunk waits for exactly the earlier ones that share a node with it") {
    for (const Mesh& mesh : {square_mesh(1), square_mesh(15), cube_mesh(4), raise_degree(ring_mesh(20, 5, 9), 3)}) {
        const ElementChunks chunks = chunk_elements(mesh);
        std::vector<std::set<int>> nodes;
        for (int t = 0; t < chunks.count(); ++t) {
            nodes.push_back(nodes_of(mesh, chunks, chunks.turn[t]));
            std::vector<int> expected, waits = waits_of(chunks, t);
            for (int earlier = 0; earlier < t; ++earlier)
                if (share_node(nodes[earlier], nodes[t])) expected.push_back(earlier);
            std::sort(waits.begin(), waits.end());
            CHECK(waits == expected);
        }
        CHECK(chunks.wait_start.size() == static_cast<std::size_t>(chunks.count()) + 1);
        CHECK(chunks.wait_start.back() == static_cast<int>(chunks.wait_for.size()));
    }
}

TEST_CASE("every node sees its chunks in the order of their turns, for any number of threads and every time") {
    const Mesh mesh = cube_mesh(8);
    const ElementChunks chunks = chunk_elements(mesh);
    std::vector<std::vector<int>> expected(mesh.nodes());
    for (int chunk : chunks.turn)
        for (int node : nodes_of(mesh, chunks, chunk)) expected[node].push_back(chunk);
    const int before = max_threads();
    for (int threads : {1, 2, 3, 8, 2}) {
        set_threads(threads);
        std::vector<std::vector<int>> seen(mesh.nodes());
        chunks.in_turn(true, [&](int chunk) {
            for (int node : nodes_of(mesh, chunks, chunk)) seen[node].push_back(chunk);
        });
        CHECK(seen == expected);
    }
    set_threads(before);
}

TEST_CASE("a turn waits however long the earlier one takes, every time") {
    ElementChunks chain;
    const int count = 40;
    chain.wait_start = {0};
    for (int t = 0; t < count; ++t) {
        chain.turn.push_back(t);
        if (t > 0) chain.wait_for.push_back(t - 1);
        chain.wait_start.push_back(static_cast<int>(chain.wait_for.size()));
    }
    const ElementChunks copy = chain, *const again[] = {&chain, &chain, &copy, &chain};
    const int before = max_threads();
    set_threads(2);
    for (const ElementChunks* chunks : again) {
        std::atomic<int> next = 0;
        bool in_order = true;
        chunks->in_turn(true, [&](int chunk) {
            if (chunk % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            in_order = in_order && next++ == chunk;
        });
        CHECK(in_order);
        CHECK(next == count);
    }
    set_threads(before);
}

TEST_CASE("a mesh of some size has chunks for many threads, which seldom wait") {
    for (const Mesh& mesh : {square_mesh(40), cube_mesh(10), raise_degree(ring_mesh(40, 10, 9), 4)}) {
        const ElementChunks chunks = chunk_elements(mesh);
        CHECK(chunks.count() >= 90);
        CHECK(close_waits(chunks) < 0.1);
    }
}

TEST_CASE("elements in an order without rhyme are put into one where chunks have few neighbours") {
    for (Mesh mesh : {square_mesh(40), cube_mesh(10)}) {
        const std::vector<int> ordered = mesh.elements;
        const int m = mesh.element_nodes(), count = mesh.element_count();
        for (int e = 0; e < count; ++e)  // 1009 and the number of elements have no common divisor
            std::copy_n(&ordered[static_cast<long long>(e) * 1009 % count * m], m, &mesh.elements[e * m]);
        const ElementChunks chunks = chunk_elements(mesh);
        CHECK(chunks.count() >= 100);
        CHECK(chunks.wait_for.size() <= static_cast<std::size_t>(chunks.count() * (mesh.dim == 2 ? 5 : 15)));
        CHECK(close_waits(chunks) < 0.1);
        CHECK(std::set<int>(chunks.order.begin(), chunks.order.end()).size() == static_cast<std::size_t>(count));
    }
}
