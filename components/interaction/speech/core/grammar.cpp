#include "interaction/speech/core/grammar.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace usher::speech {

namespace {

constexpr std::array<std::string_view, 20> kSmall{
    "zero",     "one",     "two",     "three",     "four",     "five",    "six",
    "seven",    "eight",   "nine",    "ten",       "eleven",   "twelve",  "thirteen",
    "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen"};
constexpr std::array<std::string_view, 10> kTens{"",      "",      "twenty",  "thirty", "forty",
                                                 "fifty", "sixty", "seventy", "eighty", "ninety"};

struct OtherWords {
  std::string_view option_id;
  std::string_view words;
};
// Few: the thesis found that each further word is one more that noise is taken for (section 7.3).
constexpr OtherWords kOtherWords[] = {{"yes", "yes"},           {"yes", "yeah"},
                                      {"yes", "yes please"},    {"no", "no"},
                                      {"no", "no thank you"},   {"no", "no thanks"},
                                      {"start", "let's go"},    {"continue", "go on"},
                                      {"stay", "i am here"},    {"done", "okay"},
                                      {"where_is", "where is"}, {"repeat", "say again"},
                                      {"languages", "language"}};

struct LanguageName {
  std::string_view option_id;
  std::string_view words;
};
constexpr LanguageName kLanguageNames[] = {{"language:en", "english"},
                                           {"language:de", "german"},
                                           {"language:fr", "french"},
                                           {"language:mi", "maori"}};

void append(std::string& text, std::string_view words) {
  if (words.empty()) return;
  if (!text.empty()) text += ' ';
  text += words;
}

/// 0..99
std::string two_digits(unsigned number) {
  if (number < kSmall.size()) return std::string(kSmall[number]);
  std::string text(kTens[number / 10]);
  if (number % 10 != 0) append(text, kSmall[number % 10]);
  return text;
}

std::string digit_by_digit(std::string_view digits) {
  std::string text;
  for (const char digit : digits) append(text, kSmall[static_cast<std::size_t>(digit - '0')]);
  return text;
}

std::string number_words(std::string_view digits) {
  const auto value = [](std::string_view part) {
    unsigned number = 0;
    for (const char digit : part) number = 10 * number + static_cast<unsigned>(digit - '0');
    return number;
  };
  if (digits.front() == '0' && digits.size() > 1) return digit_by_digit(digits);
  if (digits.size() <= 2) return two_digits(value(digits));
  if (digits.size() == 3) {
    std::string text(kSmall[static_cast<std::size_t>(digits[0] - '0')]);
    append(text, "hundred");
    const unsigned rest = value(digits.substr(1));
    if (rest != 0) append(text, two_digits(rest));
    return text;
  }
  if (digits.size() == 4 && digits[2] != '0') {
    std::string text = two_digits(value(digits.substr(0, 2)));
    append(text, two_digits(value(digits.substr(2))));
    return text;
  }
  return digit_by_digit(digits);
}

/// The letter without its accent for the two bytes of a Latin letter in UTF-8; 0 for others.
char plain_letter(unsigned char first, unsigned char second) {
  const unsigned code = ((first & 0x1FU) << 6U) | (second & 0x3FU);
  // U+00C0..U+00FF, then the long vowels of Maori.
  constexpr std::string_view kLatin1 =
      "aaaaaaaceeeeiiiidnooooo ouuuuy saaaaaaaceeeeiiiidnooooo ouuuuy y";
  if (code >= 0xC0 && code <= 0xFF) return kLatin1[code - 0xC0];
  switch (code) {
    case 0x100:
    case 0x101:
      return 'a';
    case 0x112:
    case 0x113:
      return 'e';
    case 0x12A:
    case 0x12B:
      return 'i';
    case 0x14C:
    case 0x14D:
      return 'o';
    case 0x16A:
    case 0x16B:
      return 'u';
    default:
      return 0;
  }
}

void offer(std::vector<Phrase>& phrases, const std::string& option_id, const std::string& label,
           std::string words) {
  if (words.empty() || phrases.size() >= kMostPhrases) return;
  const bool there = std::any_of(phrases.begin(), phrases.end(),
                                 [&](const Phrase& phrase) { return phrase.words == words; });
  if (!there) phrases.push_back({option_id, label, std::move(words)});
}

void offer_all(std::vector<Phrase>& phrases, std::span<const Option> options) {
  for (const Option& option : options) {
    if (option.takes_text) continue;
    const auto named =
        std::find_if(std::begin(kLanguageNames), std::end(kLanguageNames),
                     [&](const LanguageName& language) { return language.option_id == option.id; });
    if (named != std::end(kLanguageNames))
      offer(phrases, option.id, option.label, std::string(named->words));
    else
      offer(phrases, option.id, option.label, spoken_words(option.label));
    for (const OtherWords& other : kOtherWords) {
      if (other.option_id == option.id)
        offer(phrases, option.id, option.label, std::string(other.words));
    }
  }
}

}  // namespace

std::string spoken_words(std::string_view text) {
  std::string result, word;
  const auto end_word = [&] {
    while (!word.empty() && word.back() == '\'') word.pop_back();
    append(result, word);
    word.clear();
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (std::isdigit(byte) != 0) {
      end_word();
      std::size_t end = i;
      while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end])) != 0) ++end;
      const bool decimals = i >= 2 && text[i - 1] == '.' &&
                            std::isdigit(static_cast<unsigned char>(text[i - 2])) != 0;
      if (decimals) append(result, "point");
      const auto digits = text.substr(i, end - i);
      append(result, decimals ? digit_by_digit(digits) : number_words(digits));
      i = end - 1;
    } else if (std::isalpha(byte) != 0) {
      word += static_cast<char>(std::tolower(byte));
    } else if (byte == '\'' && !word.empty()) {
      word += '\'';
    } else if ((byte & 0xE0U) == 0xC0U && i + 1 < text.size()) {
      const char plain = plain_letter(byte, static_cast<unsigned char>(text[++i]));
      if (plain >= 'a' && plain <= 'z')
        word += plain;
      else
        end_word();
    } else {
      end_word();
      if (byte == '&') append(result, "and");
    }
  }
  end_word();
  return result;
}

std::vector<Phrase> phrases_for(std::span<const Option> options) {
  std::vector<Phrase> phrases;
  offer_all(phrases, options);
  if (phrases.size() == kMostPhrases) phrases.pop_back();
  offer(phrases, std::string(kStop), std::string(kStop), std::string(kStop));
  return phrases;
}

std::vector<Phrase> phrases_for_question(std::span<const Option> options) {
  std::vector<Phrase> phrases;
  const Option answers[] = {{std::string(kYes), "yes", false}, {std::string(kNo), "no", false}};
  offer_all(phrases, answers);
  offer_all(phrases, options);
  if (phrases.size() == kMostPhrases) phrases.pop_back();
  offer(phrases, std::string(kStop), std::string(kStop), std::string(kStop));
  return phrases;
}

std::string jsgf(std::span<const Phrase> phrases) {
  std::string text = "#JSGF V1.0;\ngrammar screen;\npublic <answer> = ";
  for (std::size_t i = 0; i < phrases.size(); ++i) {
    if (i > 0) text += " | ";
    text += phrases[i].words;
  }
  return text + ";\n";
}

}  // namespace usher::speech
