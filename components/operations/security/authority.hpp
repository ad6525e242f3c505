#pragma once

#include <memory>
#include <string>

#include "foundation/result/result.hpp"

namespace usher::operations {

/// A certificate with its private key, and the one that signs for a robot.
struct KeyPair {
  std::string certificate;  ///< PEM, public
  std::string key;          ///< PEM, private
};

/// Signs identities and documents for one robot: an elliptic-curve CA (P-256, SHA-256) as
/// DDS-Security 1.1 wants it (9.3.1).
class Authority {
 public:
  /// A new CA. Valid from yesterday (hosts' clocks differ) for `days`.
  static Result<Authority> create(const std::string& name, int days);
  /// From what create() made. Fails when the two do not belong together.
  static Result<Authority> load(const KeyPair& pair);
  ~Authority();
  Authority(Authority&& other) noexcept;
  Authority& operator=(Authority&& other) noexcept;

  Result<KeyPair> pair() const;
  /// A new key for `name`, certified as subject_of(name).
  Result<KeyPair> issue(const std::string& name, int days) const;
  /// The document as S/MIME with its signature beside it.
  Result<std::string> sign(const std::string& document) const;

 private:
  struct Implementation;
  explicit Authority(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// "CN=amcl,O=Usher": how permissions name the certificate of `name`, after RFC 2253.
std::string subject_of(const std::string& name);

/// What a CA's certificate is asked about; both need no private key.
/// Fails unless the CA issued the certificate for `name`, and both are valid today.
Status verify_certificate(const std::string& certificate, const std::string& authority,
                          const std::string& name);
/// The document inside an S/MIME file; fails unless the CA signed exactly these bytes.
Result<std::string> verify_document(const std::string& smime, const std::string& authority);

}  // namespace usher::operations
