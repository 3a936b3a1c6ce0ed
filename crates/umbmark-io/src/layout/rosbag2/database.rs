//! One file of a bag in SQLite.

use super::super::messages::{
    Channel, Container, Contents, DEFINITIONS, Definition, LONGEST, Opened, Record, Stop, Visit,
};
use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags, params_from_iter};
use std::collections::BTreeMap;
use std::path::Path;

/// Topics, at most.
const MOST_TOPICS: usize = 1 << 12;

struct Database {
    connection: Connection,
    size: u64,
    contents: Contents,
}

/// Opens a file, whose messages are in tables as `rosbag2_storage_sqlite3` makes them.
pub(super) fn open(path: &Path) -> Opened {
    let size = std::fs::metadata(path)?.len();
    let connection = connect(path).map_err(broken)?;
    let contents = contents(&connection).map_err(broken)?;
    Ok(Box::new(Database { connection, size, contents }))
}

/// A connection that writes nothing, and trusts nothing but tables.
fn connect(path: &Path) -> rusqlite::Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(path, flags)?;
    connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, LONGEST as i32)?;
    connection.pragma_update(None, "trusted_schema", false)?;
    Ok(connection)
}

impl Container for Database {
    fn size(&self) -> u64 {
        self.size
    }

    fn contents(&mut self) -> Option<Contents> {
        (!self.contents.channels.is_empty()).then(|| self.contents.clone())
    }

    fn walk(&mut self, wanted: &dyn Fn(u16) -> bool, visit: &mut Visit) -> Result<(), Stop> {
        let Contents { definitions, channels, .. } = &self.contents;
        for (id, definition) in definitions {
            visit(Record::Schema { id: *id, definition: definition.clone() })?;
        }
        for (id, channel) in channels {
            visit(Record::Channel { id: *id, channel: channel.clone() })?;
        }
        let ids: Vec<u16> = channels.keys().copied().filter(|id| wanted(*id)).collect();
        let places = vec!["?"; ids.len()].join(",");
        let asked = format!("SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({places}) ORDER BY id");
        let mut statement = self.connection.prepare(&asked).map_err(broken)?;
        let mut rows = statement.query(params_from_iter(ids)).map_err(broken)?;
        while let Some(row) = rows.next().map_err(broken)? {
            let (channel, time) = (row.get(0).map_err(broken)?, row.get::<_, i64>(1).map_err(broken)?);
            let data = row.get_ref(2).and_then(|data| Ok(data.as_blob()?)).map_err(broken)?;
            visit(Record::Message { channel, log_time: u64::try_from(time).unwrap_or(0), data })?;
        }
        Ok(())
    }
}

fn contents(connection: &Connection) -> rusqlite::Result<Contents> {
    // A view could be made to run for ever.
    let tables: i64 = connection.query_row(
        "SELECT count(*) FROM sqlite_master WHERE name IN ('topics', 'messages') AND type = 'table' AND sql NOT LIKE '%VIRTUAL%'",
        [],
        |row| row.get(0),
    )?;
    if tables != 2 {
        return Err(rusqlite::Error::InvalidQuery);
    }
    let mut contents = Contents::default();
    let texts = definitions(connection).unwrap_or_default();
    let mut asked = connection.prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id")?;
    let topics = asked.query_map([], |row| {
        Ok((row.get::<_, u16>(0)?, row.get::<_, String>(1)?, row.get::<_, String>(2)?, row.get::<_, String>(3)?))
    })?;
    for topic in topics.take(MOST_TOPICS) {
        let (id, topic, name, encoding) = topic?;
        let (language, text) = texts.get(&name).cloned().unwrap_or_else(|| {
            let known = DEFINITIONS.iter().find(|known| known.name == name).map(|known| known.text());
            ("ros2msg".to_owned(), known.unwrap_or_default())
        });
        contents.definitions.insert(id, Definition { name, encoding: language, data: text.into_bytes() });
        contents.channels.insert(id, Channel { schema: id, topic, encoding });
    }
    let mut asked = connection
        .prepare("SELECT topic_id, count(*), min(timestamp), max(timestamp) FROM messages GROUP BY topic_id")?;
    let counted = asked.query_map([], |row| {
        Ok((row.get::<_, u16>(0)?, row.get::<_, i64>(1)?, row.get::<_, i64>(2)?, row.get::<_, i64>(3)?))
    })?;
    let mut counts: BTreeMap<u16, u64> = contents.channels.keys().map(|id| (*id, 0)).collect();
    for own in counted {
        let (id, count, first, last) = own?;
        let [count, first, last] = [count, first, last].map(|number| u64::try_from(number).unwrap_or(0));
        counts.insert(id, count);
        let [from, to] = contents.span.unwrap_or([first, last]);
        contents.span = Some([from.min(first), to.max(last)]);
    }
    contents.counts = Some(counts);
    Ok(contents)
}

/// The definitions of types, where the bag has them (since ROS 2 Iron), in which language.
fn definitions(connection: &Connection) -> rusqlite::Result<BTreeMap<String, (String, String)>> {
    let asked = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions";
    let mut asked = connection.prepare(asked)?;
    let rows = asked.query_map([], |row| Ok((row.get(0)?, (row.get(1)?, row.get(2)?))))?;
    rows.take(MOST_TOPICS).collect()
}

/// Damage, in words for people.
fn broken(error: rusqlite::Error) -> Stop {
    let what = match error {
        rusqlite::Error::InvalidQuery => "it has no tables topics and messages, as bags of ROS 2 have".to_owned(),
        rusqlite::Error::SqliteFailure(_, Some(text)) => format!("SQLite says: {text}"),
        error => format!("SQLite says: {error}"),
    };
    Stop::damage(None, what)
}

#[cfg(test)]
mod tests {
    use super::super::super::messages::damaged::{Damaged, read};
    use rusqlite::{Connection, params};
    use umbmark_core::drive::Robot;

    /// A bag of counts as ROS 2 Jazzy writes it, changed by some SQL.
    fn bag(change: &str) -> Vec<u8> {
        let file = tempfile::NamedTempFile::new().unwrap();
        let connection = Connection::open(file.path()).unwrap();
        connection
            .execute_batch(
                "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                 serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
                 CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
                 encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
                 CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
                 data BLOB NOT NULL);
                 INSERT INTO topics VALUES (5, '/ticks', 'demo/msg/Ticks', 'cdr', '', '');
                 INSERT INTO message_definitions VALUES (1, 'demo/msg/Ticks', 'ros2msg', 'int32 left\nint32 right\n', '');",
            )
            .unwrap();
        for k in 0..40_i32 {
            let data = [vec![0, 1, 0, 0], (3 * k).to_le_bytes().to_vec(), (2 * k).to_le_bytes().to_vec()].concat();
            let time = 1_600_000_000_000_000_000 + 100_000_000 * i64::from(k);
            let insert = "INSERT INTO messages(topic_id, timestamp, data) VALUES (5, ?, ?)";
            connection.execute(insert, params![time, data]).unwrap();
        }
        connection.execute_batch(change).unwrap();
        drop(connection);
        std::fs::read(file.path()).unwrap()
    }

    #[test]
    fn counts_and_times_are_those_of_the_messages() {
        let log = read(&bag("")).unwrap();
        assert_eq!((&log.left[..3], log.right[39]), (&[0.0, 3.0, 6.0][..], 78.0));
        assert!((log.time[39] - log.time[0] - 3.9).abs() < 1e-9);
    }

    #[test]
    fn other_databases_are_refused() {
        let said = |change: &str| read(&bag(change)).unwrap_err();
        let none = "it has no tables topics and messages";
        assert!(said("DROP TABLE topics").contains(none));
        let endless = "ALTER TABLE messages RENAME TO own; CREATE VIEW messages AS WITH RECURSIVE n(id) AS \
                       (SELECT 1 UNION ALL SELECT id + 1 FROM n) SELECT id, 5 AS topic_id, id AS timestamp, x'00' AS data FROM n";
        assert!(said(endless).contains(none));
        assert!(said("UPDATE messages SET data = 'text'").contains("SQLite says"));
        assert!(said("DELETE FROM message_definitions").contains("no topic holds wheel counts"));
    }

    #[test]
    fn damage_makes_no_panic_and_no_number_that_is_none() {
        Damaged { good: &bag(""), purpose: 44, share: 20 }.read_all(&Robot::labmate());
    }
}
