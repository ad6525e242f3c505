#include "operations/security/authority.hpp"

#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <array>
#include <cstdint>
#include <utility>

namespace usher::operations {

namespace {

constexpr const char* kOrganization = "Usher";
constexpr long kDay = 24L * 60 * 60;
constexpr std::size_t kLargestDocument = 1 << 20;

template <auto Free>
struct Freeing {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Key = std::unique_ptr<EVP_PKEY, Freeing<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freeing<X509_free>>;
using Name = std::unique_ptr<X509_NAME, Freeing<X509_NAME_free>>;
using Buffer = std::unique_ptr<BIO, Freeing<BIO_free_all>>;
using Signature = std::unique_ptr<PKCS7, Freeing<PKCS7_free>>;
using Store = std::unique_ptr<X509_STORE, Freeing<X509_STORE_free>>;
using StoreContext = std::unique_ptr<X509_STORE_CTX, Freeing<X509_STORE_CTX_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freeing<X509_EXTENSION_free>>;

Error failure(const std::string& what) {
  std::array<char, 256> reason{};
  const unsigned long code = ERR_get_error();
  ERR_clear_error();
  if (code == 0) return Error{what};
  ERR_error_string_n(code, reason.data(), reason.size());
  return Error{what + ": " + reason.data()};
}

Buffer reading(const std::string& text) {
  return Buffer(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}
Buffer writing() { return Buffer(BIO_new(BIO_s_mem())); }
std::string content(BIO* buffer) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(buffer, &data);
  return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string();
}

Name name_of(const std::string& common_name) {
  Name name(X509_NAME_new());
  const auto add = [&](const char* field, const std::string& value) {
    return X509_NAME_add_entry_by_txt(name.get(), field, MBSTRING_ASC,
                                      reinterpret_cast<const unsigned char*>(value.data()),
                                      static_cast<int>(value.size()), -1, 0) == 1;
  };
  if (!name || !add("O", kOrganization) || !add("CN", common_name)) return nullptr;
  return name;
}

Key new_key() { return Key(EVP_EC_gen("P-256")); }

Certificate read_certificate(const std::string& pem) {
  return Certificate(PEM_read_bio_X509(reading(pem).get(), nullptr, nullptr, nullptr));
}

Result<KeyPair> to_pem(X509* certificate, EVP_PKEY* key) {
  const Buffer public_part = writing();
  const Buffer private_part = writing();
  if (PEM_write_bio_X509(public_part.get(), certificate) != 1 ||
      PEM_write_bio_PrivateKey(private_part.get(), key, nullptr, nullptr, 0, nullptr, nullptr) != 1)
    return failure("a key could not be written");
  return KeyPair{content(public_part.get()), content(private_part.get())};
}

bool add_extension(X509* certificate, X509* issuer, int kind, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, kind, value));
  return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

/// Certifies `key` as `subject`. A null issuer makes a CA that certifies itself.
Certificate certify(EVP_PKEY* key, const std::string& subject, X509* issuer, EVP_PKEY* issuer_key,
                    int days) {
  Certificate certificate(X509_new());
  const Name name = name_of(subject);
  std::uint64_t serial = 0;
  if (!certificate || !name || RAND_bytes(reinterpret_cast<unsigned char*>(&serial), 8) != 1)
    return nullptr;
  X509* made = certificate.get();
  const bool is_authority = issuer == nullptr;
  const X509_NAME* issuer_name = is_authority ? name.get() : X509_get_subject_name(issuer);
  const bool good = X509_set_version(made, X509_VERSION_3) == 1 &&
                    ASN1_INTEGER_set_uint64(X509_get_serialNumber(made), serial >> 1U) == 1 &&
                    X509_gmtime_adj(X509_getm_notBefore(made), -kDay) != nullptr &&
                    X509_gmtime_adj(X509_getm_notAfter(made), kDay * days) != nullptr &&
                    X509_set_pubkey(made, key) == 1 &&
                    X509_set_subject_name(made, name.get()) == 1 &&
                    X509_set_issuer_name(made, issuer_name) == 1 &&
                    add_extension(made, is_authority ? made : issuer, NID_basic_constraints,
                                  is_authority ? "critical,CA:TRUE" : "critical,CA:FALSE") &&
                    X509_sign(made, issuer_key, EVP_sha256()) > 0;
  return good ? std::move(certificate) : nullptr;
}

}  // namespace

struct Authority::Implementation {
  Certificate certificate;
  Key key;
};

Authority::Authority(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
Authority::~Authority() = default;
Authority::Authority(Authority&& other) noexcept = default;
Authority& Authority::operator=(Authority&& other) noexcept = default;

Result<Authority> Authority::create(const std::string& name, int days) {
  auto made = std::make_unique<Implementation>();
  made->key = new_key();
  if (!made->key) return failure("no key could be made");
  made->certificate = certify(made->key.get(), name, nullptr, made->key.get(), days);
  if (!made->certificate) return failure("no certificate could be made for " + name);
  return Authority(std::move(made));
}

Result<Authority> Authority::load(const KeyPair& pair) {
  auto made = std::make_unique<Implementation>();
  made->certificate = read_certificate(pair.certificate);
  if (!made->certificate) return failure("the CA's certificate is not one");
  made->key.reset(PEM_read_bio_PrivateKey(reading(pair.key).get(), nullptr, nullptr, nullptr));
  if (!made->key) return failure("the CA's key is not one");
  if (X509_check_private_key(made->certificate.get(), made->key.get()) != 1)
    return failure("the CA's key does not belong to its certificate");
  return Authority(std::move(made));
}

Result<KeyPair> Authority::pair() const {
  return to_pem(implementation_->certificate.get(), implementation_->key.get());
}

Result<KeyPair> Authority::issue(const std::string& name, int days) const {
  const Key key = new_key();
  if (!key) return failure("no key could be made for " + name);
  const Certificate certificate = certify(key.get(), name, implementation_->certificate.get(),
                                          implementation_->key.get(), days);
  if (!certificate) return failure("no certificate could be made for " + name);
  return to_pem(certificate.get(), key.get());
}

Result<std::string> Authority::sign(const std::string& document) const {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED;
  const Buffer in = reading(document);
  const Signature signature(PKCS7_sign(implementation_->certificate.get(),
                                       implementation_->key.get(), nullptr, in.get(), kFlags));
  if (!signature) return failure("a document could not be signed");
  const Buffer out = writing();
  BIO_reset(in.get());
  if (SMIME_write_PKCS7(out.get(), signature.get(), in.get(), kFlags) != 1)
    return failure("a signed document could not be written");
  return content(out.get());
}

std::string subject_of(const std::string& name) {
  const Name subject = name_of(name);
  const Buffer out = writing();
  if (!subject ||
      X509_NAME_print_ex(out.get(), subject.get(), 0, XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB) < 0)
    return {};
  return content(out.get());
}

Status verify_certificate(const std::string& certificate, const std::string& authority,
                          const std::string& name) {
  const Certificate own = read_certificate(certificate);
  const Certificate above = read_certificate(authority);
  ERR_clear_error();
  if (!own || !above) return Error{"the certificate of " + name + " or of its CA is not one"};
  const Name expected = name_of(name);
  if (!expected || X509_NAME_cmp(X509_get_subject_name(own.get()), expected.get()) != 0)
    return Error{"the certificate is not that of '" + name + "'"};
  const Store store(X509_STORE_new());
  const StoreContext context(X509_STORE_CTX_new());
  if (!store || !context || X509_STORE_add_cert(store.get(), above.get()) != 1 ||
      X509_STORE_CTX_init(context.get(), store.get(), own.get(), nullptr) != 1)
    return failure("the certificate of " + name + " could not be verified");
  if (X509_verify_cert(context.get()) != 1) {
    const int error = X509_STORE_CTX_get_error(context.get());
    ERR_clear_error();
    return Error{"the certificate of '" + name +
                 "' is not valid here: " + X509_verify_cert_error_string(error)};
  }
  return {};
}

Result<std::string> verify_document(const std::string& smime, const std::string& authority) {
  if (smime.size() > kLargestDocument) return Error{"a signed document must be at most 1 MB"};
  const Certificate above = read_certificate(authority);
  const Store store(X509_STORE_new());
  if (!above || !store || X509_STORE_add_cert(store.get(), above.get()) != 1)
    return failure("the CA's certificate is not one");
  BIO* found = nullptr;
  const Signature signature(SMIME_read_PKCS7(reading(smime).get(), &found));
  const Buffer document(found);
  if (!signature || !document) return failure("this is no signed document");
  const Buffer out = writing();
  // Fast DDS takes no certificate from the document either, only the one it was given.
  STACK_OF(X509)* signers = sk_X509_new_null();
  sk_X509_push(signers, above.get());
  const int verified = PKCS7_verify(signature.get(), signers, store.get(), document.get(),
                                    out.get(), PKCS7_TEXT | PKCS7_NOINTERN | PKCS7_NOVERIFY);
  sk_X509_free(signers);
  if (verified != 1) return failure("the CA did not sign this document");
  return content(out.get());
}

}  // namespace usher::operations
