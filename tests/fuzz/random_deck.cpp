#include "fuzz/random_deck.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "deck/deck.hpp"
#include "fuzz/harness.hpp"

namespace almesh::fuzz {
namespace {

struct Box {
    std::array<double, 3> centre{};
    double size = 0;

    explicit Box(const Mesh& mesh) {
        for (int a = 0; a < mesh.dim; ++a) {
            double low = mesh.x[a], high = mesh.x[a];
            for (int i = 0; i < mesh.nodes(); ++i) {
                low = std::min(low, mesh.x[offset(i, mesh.dim, a)]);
                high = std::max(high, mesh.x[offset(i, mesh.dim, a)]);
            }
            centre[a] = low + (high - low) / 2;
            size = std::max(size, high - low);
        }
    }
};

std::string coordinates(const std::array<double, 3>& p, int dim) {
    std::string text;
    for (int a = 0; a < dim; ++a) text += concat(" ", p[a]);
    return text;
}

RandomMotion translation(Choices& choose, const Box& box, int dim) {
    std::array<double, 3> by{};
    const double reach = box.size * (choose.yes() ? 1 : 0.125);
    for (int a = 0; a < dim; ++a) by[a] = reach * choose.fraction();
    return {"translate" + coordinates(by, dim), [by](Point p) {
                for (int a = 0; a < 3; ++a) p[a] += by[a];
                return p;
            }};
}

// About the middle of the box, in 3D about the y axis.
RandomMotion rotation(Choices& choose, const Box& box, int dim) {
    const double most = choose.yes() ? 400 : 30, degrees = most * choose.fraction();
    const std::string axis = dim == 3 ? " axis 0 2 0" : "";
    const auto turned = [degrees, box, dim](Point p) {
        const long double t = degrees * (std::numbers::pi_v<long double> / 180), s = std::sin(t), c = std::cos(t);
        const int i = dim == 3 ? 2 : 0, j = dim == 3 ? 0 : 1;  // from axis i to axis j
        const long double u = p[i] - box.centre[i], v = p[j] - box.centre[j];
        p[i] = box.centre[i] + c * u - s * v;
        p[j] = box.centre[j] + s * u + c * v;
        return p;
    };
    return {concat("rotate ", degrees, axis, " about", coordinates(box.centre, dim)), turned};
}

RandomMotion scaling(Choices& choose, const Box& box, int dim) {
    const double factor = 1 + 0.9 * choose.fraction();
    return {concat("scale ", factor, " about", coordinates(box.centre, dim)), [factor, box](Point p) {
                for (int a = 0; a < 3; ++a) p[a] = box.centre[a] + factor * (p[a] - box.centre[a]);
                return p;
            }};
}

// To which only the mesh's validity is checked.
RandomMotion other_motion(Choices& choose, const Box& box, int dim) {
    const std::string at = coordinates(box.centre, dim);
    const double radius = box.size * (1 + choose.fraction() / 2) / 2;
    switch (choose.below(4)) {
        case 0: return {"slide", nullptr};
        case 1: return {"free", nullptr};
        case 2: return {concat(dim == 2 ? "circle" : "sphere", at, " ", radius), nullptr};
        default: {
            const std::string wave = concat(" + ", 0.2 * choose.fraction() * box.size, " * sin(3 * (x - ",
                                            box.centre[0], ") / ", box.size, ")\"");
            return {dim == 2 ? concat("expression \"x\" \"y", wave) : concat("expression \"x\" \"y\" \"z", wave),
                    nullptr};
        }
    }
}

RandomMotion random_step(Choices& choose, const Box& box, int dim) {
    switch (choose.below(5)) {
        case 0: return {"fixed", [](Point p) { return p; }};
        case 1: return translation(choose, box, dim);
        case 2: return rotation(choose, box, dim);
        case 3: return scaling(choose, box, dim);
        default: return other_motion(choose, box, dim);
    }
}

// Prescribed first, then perhaps sliding.
RandomMotion random_motion(Choices& choose, const Box& box, int dim) {
    RandomMotion motion = random_step(choose, box, dim);
    if (motion.text == "fixed" || choose.below(3) != 1) return motion;  // which goes with no other step
    const RandomMotion then = random_step(choose, box, dim);
    if (then.text == "fixed") return motion;
    motion.text += "; " + then.text;
    if (motion.place && then.place)
        motion.place = [first = motion.place, second = then.place](Point p) { return second(first(p)); };
    else motion.place = nullptr;
    return motion;
}

// Of the table's short lists, in full; without the values that name a file.
const std::map<std::string, std::vector<std::string>> long_lists = {
    {"ideal", {"auto", "straight", "given", "regular", "size 0.3"}},
    {"start", {"auto", "identity", "coarse"}},
    {"final",
     {"input", "msh", "su2", "both"}}};

const std::map<std::string, int> highest = {
    {"refine", 1}, {"max_al_iterations", 12}, {"max_newton_iterations", 20}, {"quadrature", 14}, {"power", 32}};

std::vector<std::string> alternatives(const std::string& legal) {
    std::vector<std::string> list;
    for (const std::string_view word : split(legal, '|')) list.emplace_back(word);
    return list;
}

// A value as the table's text says: "auto or integer in 2..128", "number > 0", "exact | nodal".
std::string value_of(Choices& choose, const std::string& key, std::string legal) {
    if (const auto list = long_lists.find(key); list != long_lists.end())
        return list->second[choose.below(static_cast<int>(list->second.size()))];
    if (legal.starts_with("auto or ")) {
        if (choose.below(4) == 0) return "auto";
        legal.erase(0, std::string_view("auto or ").size());
    }
    if (test::has(legal, " | ")) {
        const auto list = alternatives(legal);
        return list[choose.below(static_cast<int>(list.size()))];
    }
    const auto dots = legal.find("..");
    const auto in = legal.find("in ");
    if (dots == legal.npos) {
        demand(legal == "number > 0" || legal == "number >= 0", key, ": no value is known for `", legal, "`");
        return legal == "number >= 0" && choose.below(4) == 0 ? "0" : to_text(choose.positive());
    }
    const double low = parse_double(legal.substr(in + 3, dots - in - 3)).value(),
                 high = parse_double(legal.substr(dots + 2)).value();
    if (legal.starts_with("number")) return to_text(std::clamp(choose.positive(), low, high));
    const int last = highest.contains(key) ? highest.at(key) : static_cast<int>(high), first = static_cast<int>(low);
    return std::to_string(first + choose.below(last - first + 1));
}

}  // namespace

std::map<std::string, RandomMotion> random_motions(Choices& choose, const Mesh& mesh) {
    const Box box(mesh);
    std::map<std::string, RandomMotion> motions;
    motions["rest"] = random_motion(choose, box, mesh.dim);
    // Neighbours that move in different ways contradict each other where they meet: not too many of them.
    const int count = static_cast<int>(mesh.boundaries.size());
    for (int left = choose.below(3); left > 0; --left) {
        const std::string& name = mesh.boundaries[choose.below(count)];
        motions[name] = random_motion(choose, box, mesh.dim);
    }
    return motions;
}

std::map<std::string, std::string> random_settings(Choices& choose, const Mesh& mesh) {
    const std::vector<DeckKey>& keys = deck_keys();
    std::map<std::string, std::string> settings;
    for (int left = choose.below(8); left > 0; --left) {
        const DeckKey& key = keys[choose.below(static_cast<int>(keys.size()))];
        constexpr std::array of_files_or_times = {"mesh", "output", "frames", "max_seconds", "threads"};
        if (std::find(of_files_or_times.begin(), of_files_or_times.end(), key.name) != of_files_or_times.end()) continue;
        std::string& value = settings[key.name];
        if (key.name == "title") value = quoted_where_needed(choose.word(20), "#\"");
        else if (key.name == "wall" || key.name == "contact")
            value = mesh.boundaries[choose.below(static_cast<int>(mesh.boundaries.size()))];
        else if (key.name == "degree") value = std::to_string(choose.below(mesh.dim == 2 ? 4 : 3));
        else value = value_of(choose, key.name, key.value.legal);
        Deck deck;
        try {
            set_value(deck, key, value);
        } catch (const UsageError& error) {
            throw Violation(concat("the table of keys calls it legal: ", error.what()));
        }
    }
    return settings;
}

}  // namespace almesh::fuzz
